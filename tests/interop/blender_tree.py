#!/usr/bin/env python3
"""Render a tree's .glb with Blender Cycles from several distances before its crown, side by side, under a clear sky.

  python blender_tree.py TREE.glb OUT.png [SIDE] [SAMPLES] [METRES...]

The eye looks level along −z at the height that the viewer's pictures of docs/landscapes.md have, with the same 60° upright.
"""
import math
import os
import sys

import blender_common
import numpy as np

path, picture = map(os.path.abspath, sys.argv[1:3])
side, samples = (int(sys.argv[k]) if len(sys.argv) > k else number for k, number in ((3, 440), (4, 32)))
distances_m = [float(word) for word in sys.argv[5:]] or [1.0, 5.0, 20.0, 80.0]
EYE_M = 5.0
bpy, out = blender_common.start()
bpy.ops.import_scene.gltf(filepath=path)
scene = bpy.context.scene
# The finished tree alone, not the other levels of detail that stand beside it in a scene of their own.
gltf = blender_common.read_json(path)
shown, todo = set(), list(gltf["scenes"][gltf.get("scene", 0)]["nodes"])
while todo:
    node = gltf["nodes"][todo.pop()]
    shown.add(node["name"])
    todo += node.get("children", [])
trees = [thing for thing in bpy.data.objects if thing.type == "MESH" and thing.name in shown]
for thing in bpy.data.objects:
    thing.hide_render = thing not in trees

bpy.ops.mesh.primitive_plane_add(size=4000)
grass = bpy.data.materials.new("grass")
grass.use_nodes = True
grass.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.08, 0.11, 0.03, 1)
grass.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 1
bpy.context.object.data.materials.append(grass)

world = bpy.data.worlds.new("sky")
scene.world, world.use_nodes = world, True
sky = world.node_tree.nodes.new("ShaderNodeTexSky")
sky.sky_type, sky.sun_elevation, sky.sun_rotation = "NISHITA", math.radians(40), math.radians(140)
world.node_tree.links.new(sky.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.09

camera = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
camera.data.angle, camera.data.clip_start = math.radians(60), 0.05
camera.rotation_euler = (math.radians(90), 0, 0)
scene.collection.objects.link(camera)
scene.camera = camera

# Where the crown begins before the eye: the nearest leaf beside the axis, at the eye's height.
corners = [tree.matrix_world @ vertex.co for tree in trees for vertex in tree.data.vertices]
before = [-v.y for v in corners if abs(v.x) < 0.5 and abs(v.z - EYE_M) < 0.5]
crown_m = max(before, default=0.0)

scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", samples, True
scene.cycles.transparent_max_bounces = 32
scene.view_settings.view_transform = "AgX"
scene.render.resolution_x = scene.render.resolution_y = side
scene.render.image_settings.file_format = "PNG"
pictures = []
for distance_m in distances_m:
    camera.location = (0, -(crown_m + distance_m), EYE_M)
    scene.render.filepath = f"{picture}.part.png"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(4 * side * side, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    pictures.append(pixels.reshape(side, side, 4))
    bpy.data.images.remove(image)
os.remove(f"{picture}.part.png")
sheet = bpy.data.images.new("sheet", side * len(pictures), side)
sheet.pixels.foreach_set(np.concatenate(pictures, axis=1).ravel())
sheet.filepath_raw, sheet.file_format = picture, "PNG"
sheet.save()
out.write(f"{picture}: crown at {crown_m:.2f} m, distances {distances_m} m\n")
out.flush()
os._exit(0 if os.path.exists(picture) else 1)
