#!/usr/bin/env python3
"""Render a landscape with Blender Cycles as the script of `bake export --for blender` sets it up.

  python blender_render.py SCRIPT.py OUT.png [WIDTHxHEIGHT] [SAMPLES]
"""
import os
import runpy
import sys

import blender_common

script, picture = map(os.path.abspath, sys.argv[1:3])
width, height = map(int, (sys.argv[3] if len(sys.argv) > 3 else "640x400").split("x"))
samples = int(sys.argv[4]) if len(sys.argv) > 4 else 16
bpy, out = blender_common.start()
runpy.run_path(script, run_name="__main__")
blender_common.render(bpy, picture, width, height, samples)
out.write(f"{picture}\n")
out.flush()
os._exit(0 if os.path.exists(picture) else 1)
