#!/usr/bin/env python3
"""What `bake export --for blender` wrote, set up by its own script in a new Blender file, and a plain export beside it.

  python blender_export.py SCRIPT.py PLAIN.glb [--render OUT.png WIDTHxHEIGHT SAMPLES]

Prints a JSON object. Exit 0: run twice, the script leaves one active camera, the sky, the collections, and an instance for
each tree of the file that stands where the file says; a small picture is neither black nor blown out; and nor is the
plain file's, imported with Blender's defaults. 1: something was not so.
"""
import glob
import json
import os
import runpy
import sys
import tempfile

import numpy as np

import blender_common

script, plain = map(os.path.abspath, sys.argv[1:3])
faults = []
result = {"script": script, "faults": faults}
bpy, out = blender_common.start(empty=False)
from mathutils import Vector  # Blender's, which is there only now


def check(holds, otherwise):
    if not holds:
        faults.append(otherwise)


def picture(path, size=(64, 40), samples=4):
    """Renders through the active camera with Cycles; mean luminance as shown, 0 to 1, and the part that is white."""
    blender_common.render(bpy, path, *size, samples)
    image = bpy.data.images.load(path)
    pixels = np.empty(size[0] * size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    luminance = pixels.reshape(-1, 4)[:, :3] @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    return float(luminance.mean()), float((luminance > 0.98).mean())


def check_picture(name, range_, path, **options):
    mean, white = picture(path, **options)
    result[name] = {"mean": round(mean, 3), "white": round(white, 3)}
    check(range_[0] < mean < range_[1], f"{name}: its mean luminance is {mean:.3f}, not {range_[0]} to {range_[1]}")
    check(white < 0.1, f"{name}: {white:.0%} of it is white")


folder = tempfile.mkdtemp()
for _ in range(2):
    runpy.run_path(script, run_name="__main__")
bpy.context.view_layer.update()
scene = bpy.context.scene

gltf = blender_common.read_json(glob.glob(os.path.join(os.path.dirname(script), "*.glb"))[0])
nodes, title = gltf["nodes"], gltf["scenes"][0]["name"]
matrices = blender_common.world_matrices(gltf)
shown = {child for node in nodes if node["name"] == "trees" for child in node["children"]}

check(scene.camera and scene.camera.name.startswith("start"), f"the active camera is {scene.camera}")
background = scene.world and scene.world.node_tree.nodes.get("Background")
sky = background and background.inputs["Color"].links
check(sky and 0 not in sky[0].from_node.image.size, "the world shows no sky")
collections = {c.name for c in bpy.data.collections}
top = scene.collection.children.get(title)
check(top, f"there is no collection {title}")
result["collections"] = sorted(c.name for c in top.children) if top else []
for name in ("Land", "Grass", "Trees", "Kinds of trees", "Camera and light"):
    check(name in result["collections"], f"there is no collection {name}")

far = next((node["extensions"]["GSC_instances"]["count"] for node in nodes if node["name"] == "far trees"), 0)
planted = [o for o in bpy.data.objects if o.instance_type == "FACES"]
result["far trees"] = sum(len(o.data.polygons) for o in planted)
check(result["far trees"] == far > 0, f"{result['far trees']} of {far} trees beyond the field are planted")
land = [o for o in bpy.data.objects if o.name.split(".")[0] == "apron"]
for o in planted:
    check(len(o.children) == 1 and o.children[0].data.polygons, f"{o.name} shows no tree")
    for face in list(o.data.polygons)[::50]:
        place = o.matrix_world @ face.center
        down = land[0].matrix_world.inverted()
        hit, ground, _, _ = land[0].ray_cast(down @ (place + Vector((0, 0, 50))), down.to_3x3() @ Vector((0, 0, -1)))
        above_m = place.z - (land[0].matrix_world @ ground).z
        check(hit and -1.5 < above_m < 0.1, f"a tree of {o.name} stands {above_m:.2f} m above the ground")
instances = [o for o in bpy.data.objects if o.instance_type == "COLLECTION"]
result["instances"] = len(instances)
check(len(instances) == len(shown), f"{len(instances)} instances of {len(shown)} trees")
check(sum(o.type == "MESH" and o.name.startswith("tree.") for o in bpy.data.objects) == 0, "a tree's mesh is left over")
by_tree = {o.parent.name: o for o in instances}
worst = 0.0
for index in shown:
    tree = by_tree.get(nodes[index]["name"])
    if tree is None:
        faults.append(f"{nodes[index]['name']} has no instance")
        continue
    worst = max(worst, float(np.abs(matrices[nodes[index]["children"][0]] - np.array(tree.matrix_world)).max()))
    kind = tree.instance_collection
    check(kind.name.endswith(f"-{nodes[index]['extras']['template'] + 1}"), f"{tree.name} is of {kind.name}")
    check(len(kind.objects) == 2, f"{kind.name} holds {len(kind.objects)} objects")
result["worst_place_m"] = worst
check(worst < 1e-3, f"a tree is off by {worst} m")
hazes = {m.name: sum(n.type == "GROUP" and n.node_tree.name.endswith(" haze") for n in m.node_tree.nodes) for m in bpy.data.materials if m.users and m.use_nodes
         and any(n.type == "BSDF_PRINCIPLED" for n in m.node_tree.nodes) and m.name != "Material"}
result["hazes"] = hazes
check(hazes and set(hazes.values()) == {1}, f"not every material has one haze: {hazes}")
leaves = {m.name: sum(n.type == "BSDF_TRANSLUCENT" for n in m.node_tree.nodes) for m in bpy.data.materials
          if m.users and m.name.split(".")[0] in ("leaf", "blossom", "clusters")}
result["leaves"] = leaves
check(set(leaves.values()) <= {1}, f"not every leaf lets light through once: {leaves}")
told = {m["name"] for m in gltf["materials"] if "KHR_materials_diffuse_transmission" in m.get("extensions", {})}
check(not told or leaves, f"of {told} no material arrived")
check_picture("set up by the script", (0.15, 0.7), os.path.join(folder, "script.png"))
if "--render" in sys.argv:
    path, size, samples = sys.argv[sys.argv.index("--render") + 1:][:3]
    picture(os.path.abspath(path), tuple(map(int, size.split("x"))), int(samples))

bpy.ops.wm.read_factory_settings(use_empty=False)
bpy.ops.import_scene.gltf(filepath=plain)
bpy.context.scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA" and o.name.startswith("start"))
check_picture("the plain file with Blender's defaults", (0.1, 0.7), os.path.join(folder, "plain.png"))

json.dump(result, out, indent=1, ensure_ascii=False)
out.write("\n")
out.flush()
os._exit(1 if faults else 0)  # bpy may crash while Python tears down
