#!/usr/bin/env python3
"""Import a glTF file with Blender's own importer (PyPI bpy) and compare what arrived with the file.

  python blender_check.py FILE.gltf|FILE.glb

Prints a JSON object. Exit 0: as many mesh objects as the file's scenes show, every world matrix as in the file
(so no shear was lost), a shape key for every morph target that moves exactly as far as the file says it does, every
image decoded. 1: something was not.
"""
import json
import os
import sys

import numpy as np

import blender_common

path = sys.argv[1]
bpy, out = blender_common.start()
gltf = blender_common.read_json(path)
faults = []
result = {"file": path, "blender": bpy.app.version_string, "faults": faults}
try:
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(path))
except RuntimeError as error:
    faults.append(f"import failed: {error}")
bpy.context.view_layer.update()

nodes, meshes, accessors = gltf.get("nodes", []), gltf.get("meshes", []), gltf.get("accessors", [])
shown, todo = set(), [n for scene in gltf.get("scenes", []) for n in scene["nodes"]]
while todo:
    node = todo.pop()
    shown.add(node)
    todo += nodes[node].get("children", [])
with_mesh = [i for i in shown if "mesh" in nodes[i]]

objects = {o.name: o for o in bpy.data.objects}
mesh_objects = [o for o in bpy.data.objects if o.type == "MESH"]
result |= {"objects": len(objects), "mesh_objects": len(mesh_objects), "meshes": len(bpy.data.meshes),
           "lights": sum(o.type == "LIGHT" for o in bpy.data.objects),
           "cameras": sum(o.type == "CAMERA" for o in bpy.data.objects)}
if len(mesh_objects) != len(with_mesh):
    faults.append(f"{len(mesh_objects)} mesh objects arrived of {len(with_mesh)}")

worst = 0.0
world = blender_common.world_matrices(gltf)
for i in with_mesh:
    arrived = objects.get(nodes[i]["name"])
    if arrived is None:
        faults.append(f"object {nodes[i]['name']} did not arrive")
        continue
    expected = world[i]
    error = float(np.abs(expected - np.array(arrived.matrix_world)).max()) / max(1.0, float(np.abs(expected).max()))
    worst = max(worst, error)
    if error > 1e-4:
        faults.append(f"object {arrived.name}: its world matrix is off by {error:.3g}")
result["worst_matrix_error"] = worst

keys, used = 0, {nodes[i]["mesh"] for i in with_mesh}
for index in sorted(used):
    mesh = meshes[index]
    names = mesh.get("extras", {}).get("targetNames", [])
    arrived = bpy.data.meshes.get(mesh["name"])
    if arrived is None:
        faults.append(f"mesh {mesh['name']} did not arrive")
        continue
    for target, name in enumerate(names):
        block = arrived.shape_keys and arrived.shape_keys.key_blocks.get(name)
        if not block:
            faults.append(f"mesh {arrived.name}: no shape key {name}")
            continue
        keys += 1
        # The greatest move along each axis, which the accessors' bounds state.
        bounds = [accessors[p["targets"][target]["POSITION"]] for p in mesh["primitives"]]
        stated = max(max(map(abs, b["min"] + b["max"])) for b in bounds)
        count = len(arrived.vertices) * 3
        moved, base = np.empty(count, np.float32), np.empty(count, np.float32)
        block.data.foreach_get("co", moved)
        block.relative_key.data.foreach_get("co", base)
        if abs(float(np.abs(moved - base).max()) - stated) > 1e-3 * max(1.0, stated):
            faults.append(f"shape key {name} of {arrived.name} moves {np.abs(moved - base).max()}, not {stated}")
result["shape_keys"] = keys

images = [image for image in bpy.data.images if image.source == "FILE"]
result["images"] = len(images)
faults += [f"image {image.name} was not decoded" for image in images if 0 in image.size]

json.dump(result, out, indent=1, ensure_ascii=False)
out.write("\n")
out.flush()
os._exit(1 if faults else 0)  # bpy may crash while Python tears down
