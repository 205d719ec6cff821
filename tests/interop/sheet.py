#!/usr/bin/env python3
"""Put four pictures of one size on a 2×2 sheet:  python sheet.py SHEET.jpg A.png B.png C.png D.png"""
import os
import sys

import numpy as np

import blender_common

sheet, *names = map(os.path.abspath, sys.argv[1:])
bpy, out = blender_common.start()
tiles = []
for name in names:
    image = bpy.data.images.load(name)
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    tiles.append(pixels.reshape(height, width, 4)[:, :, :3])
gap_px = 4
height, width = tiles[0].shape[:2]
# Rows run upwards in Blender.
whole = np.ones((2 * height + gap_px, 2 * width + gap_px, 4), np.float32)
for i, tile in enumerate(tiles[:4]):
    y = (height + gap_px) * (1 - i // 2)
    x = (width + gap_px) * (i % 2)
    whole[y:y + height, x:x + width, :3] = tile
image = bpy.data.images.new("sheet", whole.shape[1], whole.shape[0])
image.pixels.foreach_set(whole.ravel())
image.filepath_raw = sheet
image.file_format = "JPEG"
image.save(quality=88)
out.write(f"{sheet}: {os.path.getsize(sheet)} bytes\n")
out.flush()
os._exit(0)
