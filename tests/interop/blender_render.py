#!/usr/bin/env python3
"""Render scene.gltf through its own camera with Blender Cycles, lit by its sun and its EXR sky.

  python blender_render.py SCENE.gltf OUT.png [WIDTHxHEIGHT] [SAMPLES]

Lights come in as "Unitless" so that the sun's irradiance is in the units of the EXR (see GSC_sky.md).
"""
import math
import os
import sys

import blender_common

path, picture = map(os.path.abspath, sys.argv[1:3])
width, height = map(int, (sys.argv[3] if len(sys.argv) > 3 else "640x400").split("x"))
samples = int(sys.argv[4]) if len(sys.argv) > 4 else 16
bpy, out = blender_common.start()
bpy.ops.import_scene.gltf(filepath=path, export_import_convert_lighting_mode="COMPAT")
scene = bpy.context.scene
sky = blender_common.read_json(path)["scenes"][0]["extensions"]["GSC_sky"]

scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA")
for light in (o.data for o in bpy.data.objects if o.type == "LIGHT"):
    light.angle = 2 * sky["sunAngularRadiusRad"]

world = bpy.data.worlds.new("sky")
scene.world, world.use_nodes = world, True
tree = world.node_tree
background = tree.nodes["Background"]
background.inputs["Strength"].default_value = sky["exposure"]
environment = tree.nodes.new("ShaderNodeTexEnvironment")
environment.image = bpy.data.images.load(os.path.join(os.path.dirname(path), sky["equirect"]["uri"]))
coordinates = tree.nodes.new("ShaderNodeTexCoord")
mapping = tree.nodes.new("ShaderNodeMapping")
# The middle column of a picture is +x to Blender; ours is glTF's −z, which is Blender's +y.
mapping.inputs["Rotation"].default_value = (0, 0, -math.pi / 2)
tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
tree.links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
tree.links.new(environment.outputs["Color"], background.inputs["Color"])

# The file says how thick the air is. glTF viewers know no air; here it is laid over by distance. Pixels that show land
# and sky in parts are taken apart by their alpha, for the sky has its air already.
FAR_M = 20000.0
scene.use_nodes = True
scene.render.film_transparent = True
view_layer = scene.view_layers[0]
view_layer.use_pass_mist = view_layer.use_pass_environment = True
world.mist_settings.start, world.mist_settings.depth, world.mist_settings.falloff = 0.0, FAR_M, "LINEAR"
nodes, links = scene.node_tree.nodes, scene.node_tree.links
nodes.clear()
layers = nodes.new("CompositorNodeRLayers")


def node(kind, operation, *values):
    made = nodes.new(kind)
    setattr(made, *operation)
    sockets = [socket for socket in made.inputs if socket.enabled][-len(values):]
    for socket, value in zip(sockets, values):
        if hasattr(value, "links"):
            links.new(value, socket)
        else:
            socket.default_value = value
    return made.outputs[0]


def scalar(operation, *values):
    return node("CompositorNodeMath", ("operation", operation), *values)


def colors(blend, factor, *values):
    return node("CompositorNodeMixRGB", ("blend_type", blend), factor, *values)


alpha = layers.outputs["Alpha"]
clear = scalar("DIVIDE", scalar("SUBTRACT", 1.0, layers.outputs["Mist"]), scalar("MAXIMUM", alpha, 1e-3))
distance_m = scalar("MULTIPLY", scalar("SUBTRACT", 1.0, scalar("MINIMUM", clear, 1.0)), FAR_M)
kept = scalar("POWER", math.exp(-sky["hazeExtinctionPerM"]), distance_m)
air = [c * sky["exposure"] for c in sky["hazeLinear"]] + [1.0]
hazy = colors("MULTIPLY", 1.0, air, alpha)
land = colors("MIX", kept, hazy, layers.outputs["Image"])
picture_node = colors("ADD", 1.0, land, layers.outputs["Env"])
opaque = nodes.new("CompositorNodeSetAlpha")
links.new(picture_node, opaque.inputs["Image"])
links.new(opaque.outputs[0], nodes.new("CompositorNodeComposite").inputs[0])

scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = samples
scene.cycles.use_denoising = True
scene.cycles.max_bounces = 6
scene.cycles.transparent_max_bounces = 32
scene.view_settings.view_transform = "AgX"
scene.render.resolution_x, scene.render.resolution_y = width, height
scene.render.image_settings.file_format = "PNG"
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
out.write(f"{picture}: {width}x{height}, {samples} samples\n")
out.flush()
os._exit(0 if os.path.exists(picture) else 1)
