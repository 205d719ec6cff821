"""What the Blender scripts share: a quiet start of PyPI's bpy, the import, and the file's own JSON."""
import json
import os
import struct

import numpy as np


def start(empty=True):
    """Blender with its glTF importer, empty or as a person finds it; its chatter goes to stderr. Returns bpy and our own
    stdout."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    import bpy
    import addon_utils
    bpy.ops.wm.read_factory_settings(use_empty=empty)
    addon_utils.enable("io_scene_gltf2", default_set=False)
    addon_utils.enable("cycles", default_set=False)
    return bpy, out


def render(bpy, path, width, height, samples):
    """Renders through the active camera with Cycles, on the processor."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.samples, scene.cycles.use_denoising = samples, samples > 4
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.filepath = "PNG", path
    bpy.ops.render.render(write_still=True)


def read_json(path):
    """The JSON of a .gltf or .glb."""
    data = open(path, "rb").read()
    if data[:4] != b"glTF":
        return json.loads(data)
    length, = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + length])


def local_matrix(node):
    """A node's transform relative to its parent as 4×4."""
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]) * np.array(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def world_matrices(gltf):
    """World matrices of all nodes in Blender's axes (z up)."""
    nodes = gltf.get("nodes", [])
    children = {child for node in nodes for child in node.get("children", [])}
    blender_from_gltf = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    world, todo = {}, [(i, np.eye(4)) for i in range(len(nodes)) if i not in children]
    while todo:
        i, parent = todo.pop()
        world[i] = parent @ local_matrix(nodes[i])
        todo += [(child, world[i]) for child in nodes[i].get("children", [])]
    inverse = np.linalg.inv(blender_from_gltf)
    return {i: blender_from_gltf @ matrix @ inverse for i, matrix in world.items()}
