# Sets up a landscape of Genescape in Blender 4.2 or later, for Cycles and Eevee alike. Written by `bake export --for
# blender`; another export replaces it unless it was changed.
#
#   blender --python THIS_FILE         or open it in Blender's text editor and press Run Script
#
# Imports the .glb beside it unless that was imported already, then sorts it into collections, makes trees instances of
# one collection for each kind, and sets camera, sun, sky, haze and view transform. Run again, it changes nothing twice.
import json
import math
import os
import struct

import bpy

SETTINGS = {}

# Names in Blender are 63 bytes at most.
TITLE = SETTINGS["title"].encode()[:50].decode(errors="ignore") or SETTINGS["landscape"]
# Metres that the view reaches: beyond the land around.
FAR_M = 40000.0
# Leaves are cards with transparent corners, many behind one another.
TRANSPARENT_BOUNCES = 32


def main():
    if not roots():
        bpy.ops.import_scene.gltf(filepath=beside(SETTINGS["scene_file"]))
        hide_startup_objects()
    if not roots():
        raise RuntimeError(f"{SETTINGS['scene_file']} holds no landscape {SETTINGS['landscape']}")
    objects = {o for root in roots() for o in (root, *root.children_recursive)}
    count = sort_into_collections(objects)
    far_count = plant_far_trees()
    set_camera(objects)
    set_sun(objects)
    set_sky()
    for material in {m for o in objects | kinds_of_trees() if o.type == "MESH" for m in o.data.materials if m}:
        let_light_through(material)
        roughen_land(material)
        add_haze(material)
    set_view()
    print(f"{TITLE}: {count} trees and {far_count} far ones of {len(SETTINGS['kinds'])} kinds; camera, sun and sky are set")


def roots():
    """What the landscape's file has at its top."""
    return [o for o in bpy.data.objects
            if o.get("landscape") == SETTINGS["landscape"] and o.parent is None and "role" not in o]


def kinds_of_trees():
    return {o for o in bpy.data.objects if o.get("landscape") == SETTINGS["landscape"] and "role" in o}


def beside(name):
    """A file beside this script, which Blender may also run from a text inside a .blend."""
    places = [globals().get("__file__"), bpy.data.filepath, *(text.filepath for text in bpy.data.texts)]
    for place in filter(None, places):
        path = os.path.join(os.path.dirname(os.path.abspath(bpy.path.abspath(place))), name)
        if os.path.exists(path):
            return path
    raise FileNotFoundError(f"{name} is not beside this script; keep the files of an export together")


def hide_startup_objects():
    """The cube and the lamp that every new Blender file begins with, unless the file is someone's work."""
    if bpy.data.filepath:
        return
    for name in ("Cube", "Light"):
        startup = bpy.data.objects.get(name)
        if startup:
            startup.hide_render = True
            startup.hide_set(True)


# ---- collections ----

def sort_into_collections(objects):
    """Land, Grass, Trees and so on below one collection; how many trees there are."""
    top = top_collection()
    library = collection("Kinds of trees", top)
    kinds = [collection(kind, library) for kind in SETTINGS["kinds"]]
    for tree in kinds_of_trees():
        move(tree, kinds[tree["template"]])
        # The finest mesh is for pictures, the proxy for the work on them.
        tree.hide_viewport, tree.hide_render = tree["role"] == "finest", tree["role"] == "proxy"
    layer = layer_collection(library, bpy.context.view_layer.layer_collection)
    if layer:
        layer.exclude = True
    trees = collection("Trees", top)
    replaced = [child for o in objects if "level" in o for child in o.children if child.type == "MESH"]
    for mesh in replaced:
        add_instance(mesh, kinds[mesh.parent["template"]], trees)
    names = {"terrain": "Land", "apron": "Land", "water": "Water", "grass": "Grass"}
    for o in objects - set(replaced):
        place = "Trees" if o.type == "EMPTY" else names.get(o.name.split(".")[0], "Camera and light")
        move(o, collection(place, top))
    objects -= set(replaced)
    bpy.data.batch_remove(replaced)
    for imported in [c for c in bpy.data.collections if c.name.split(".")[0] == "kinds of trees"]:
        if not imported.objects and not imported.children:
            bpy.data.collections.remove(imported)
    return sum(o.instance_type == "COLLECTION" for o in trees.objects)


def top_collection():
    """The landscape's own, below the scene's; the importer may have made it, below the one that was active."""
    marked = (c for c in bpy.data.collections if c.get("landscape") == SETTINGS["landscape"])
    top = next(marked, None) or bpy.data.collections.get(TITLE) or bpy.data.collections.new(TITLE)
    top["landscape"] = SETTINGS["landscape"]
    for parent in (bpy.context.scene.collection, *bpy.data.collections):
        if top.name in parent.children:
            parent.children.unlink(top)
    bpy.context.scene.collection.children.link(top)
    return top


def collection(name, parent):
    """The child of that name."""
    found = next((c for c in parent.children if c.name.split(".")[0] == name), None)
    if not found:
        found = bpy.data.collections.new(name)
        parent.children.link(found)
    return found


def layer_collection(wanted, layer):
    if layer.collection == wanted:
        return layer
    return next(filter(None, (layer_collection(wanted, child) for child in layer.children)), None)


def move(o, target):
    for old in o.users_collection:
        if old != target:
            old.objects.unlink(o)
    if o.name not in target.objects:
        target.objects.link(o)


def add_instance(mesh, kind, trees):
    """An empty in the place of a tree's mesh, which shows the whole kind. Its parent has the rest of the transform: trees
    lean and stretch, which one object cannot."""
    instance = bpy.data.objects.new(f"{mesh.parent.name} {kind.name}", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", kind
    instance.parent, instance.matrix_local = mesh.parent, mesh.matrix_local.copy()
    instance.empty_display_size = mesh.parent.empty_display_size = 0.01
    trees.objects.link(instance)


# ---- trees beyond the field ----

def plant_far_trees():
    """For each kind one object of squares, one a tree, on each of which Blender shows the kind's proxy; how many trees there are.

    Thousands of them stand hundreds of metres away, where nobody wants to take hold of one."""
    records = far_trees()
    place = collection("Far trees", top_collection()) if records else None
    for proxy in [o for o in kinds_of_trees() if o["role"] == "proxy"]:
        corners = [corner for record in records if record[12] == proxy["template"] for corner in square(record)]
        name = f"far {proxy.name}"
        if not corners or name in bpy.data.objects:
            continue
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(corners, [], [range(i, i + 4) for i in range(0, len(corners), 4)])
        trees = bpy.data.objects.new(name, mesh)
        trees.instance_type, trees.use_instance_faces_scale = "FACES", True
        trees.show_instancer_for_render = trees.show_instancer_for_viewport = False
        tree = bpy.data.objects.new(f"{name} tree", proxy.data)
        tree.parent = trees
        place.objects.link(trees)
        place.objects.link(tree)
    return len(records)


def far_trees():
    """The records of GSC_instances at the node "far trees": twelve numbers of a transform by rows, the kind, and three of a trunk."""
    with open(beside(SETTINGS["scene_file"]), "rb") as file:
        data = file.read()
    length, = struct.unpack_from("<I", data, 12)
    gltf = json.loads(data[20:20 + length])
    extensions = (node.get("extensions", {}) for node in gltf["nodes"] if node.get("name") == "far trees")
    told = next((every["GSC_instances"] for every in extensions if "GSC_instances" in every), None)
    if not told:
        return []
    view = gltf["bufferViews"][told["bufferView"]]
    start = 20 + length + 8 + view.get("byteOffset", 0)
    return list(struct.iter_unpack("<12fI3f", data[start + 16:start + view["byteLength"]]))


def square(record):
    """A square at a tree's foot, as wide as the tree is scaled, turned as it is; y is up in the file, z in Blender."""
    x, y, z, scale = record[3], -record[11], record[7], abs(record[5])
    turn = math.atan2(-record[8], record[0])
    corners = (turn + math.pi * (0.25 + 0.5 * k) for k in range(4))
    return [(x + scale * math.sqrt(0.5) * math.cos(a), y + scale * math.sqrt(0.5) * math.sin(a), z) for a in corners]


# ---- camera and light ----

def set_camera(objects):
    camera = next(o for o in objects if o.type == "CAMERA")
    camera.data.clip_end = FAR_M
    bpy.context.scene.camera = camera
    for screen in bpy.data.screens:
        for space in (s for area in screen.areas for s in area.spaces if s.type == "VIEW_3D"):
            space.clip_end = max(space.clip_end, FAR_M)


def set_sun(objects):
    sun = next(o for o in objects if o.type == "LIGHT").data
    sun.energy, sun.color, sun.angle = SETTINGS["sun_strength"], SETTINGS["sun_color"], SETTINGS["sun_angle_rad"]


def set_sky():
    name = f"{TITLE} sky"
    world = bpy.data.worlds.get(name) or bpy.data.worlds.new(name)
    bpy.context.scene.world, world.use_nodes = world, True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    environment, mapping = sky_nodes(nodes)
    coordinates = nodes.new("ShaderNodeTexCoord")
    background = nodes.new("ShaderNodeBackground")
    background.inputs["Strength"].default_value = SETTINGS["sky_strength"]
    output = nodes.new("ShaderNodeOutputWorld")
    links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], environment.inputs["Vector"])
    links.new(environment.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs["Background"], output.inputs["Surface"])
    for i, node in enumerate((coordinates, mapping, environment, background, output)):
        node.location = (300 * i, 0)
    if hasattr(world, "sun_threshold"):
        world.sun_threshold = 0.0  # Eevee would take the glow around the sun for a second one


def sky_nodes(nodes):
    """The sky's picture, and what turns a direction to it."""
    environment = nodes.new("ShaderNodeTexEnvironment")
    environment.image = bpy.data.images.load(beside(SETTINGS["sky_file"]), check_existing=True)
    mapping = nodes.new("ShaderNodeMapping")
    # The middle column of a picture is +x to Blender; ours is north, which is +y.
    mapping.inputs["Rotation"].default_value = (0, 0, -math.pi / 2)
    return environment, mapping


# ---- materials ----

def principled(material):
    """The shader that the importer made, if the material has one still."""
    return next((n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)


# ---- leaves ----

# Parts of its colour that a leaf gives back and lets through: those of Genescape's viewer. A file says how what arrives is shared, and
# by its shares a crown is half as bright as the one that was voted for.
REFLECTED, TRANSMITTED = 0.8, 0.6


def let_light_through(material):
    """What the file says of light through leaves (KHR_materials_diffuse_transmission), which Blender's importer leaves out."""
    told = material.get("light_through")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = principled(material)
    if not told or not shader or any(n.type == "BSDF_TRANSLUCENT" for n in nodes):
        return
    tint, bright, through = (nodes.new(kind) for kind in ("ShaderNodeMixRGB", "ShaderNodeMixRGB", "ShaderNodeBsdfTranslucent"))
    clear, cut_out, both = (nodes.new(kind) for kind in ("ShaderNodeBsdfTransparent", "ShaderNodeMixShader", "ShaderNodeMixShader"))
    part = min(max(told["part"], 0.01), 0.99)
    # No leaf gives back more than falls on it.
    for node, factor in ((bright, [REFLECTED / (1.0 - part)] * 3), (tint, [c * TRANSMITTED / part for c in told["tint"]])):
        node.blend_type, node.inputs["Fac"].default_value, node.use_clamp = "MULTIPLY", 1.0, True
        node.inputs["Color2"].default_value = (*factor, 1.0)
    color = shader.inputs["Base Color"]
    for source, target in ((color, tint.inputs["Color1"]), (color, bright.inputs["Color1"]), (shader.inputs["Normal"], through.inputs["Normal"]),
                           (shader.inputs["Alpha"], cut_out.inputs[0])):
        if source.links:
            links.new(source.links[0].from_socket, target)
        elif source.name != "Normal":
            target.default_value = source.default_value
    links.new(bright.outputs["Color"], color)
    links.new(tint.outputs["Color"], through.inputs["Color"])
    links.new(clear.outputs[0], cut_out.inputs[1])
    links.new(through.outputs[0], cut_out.inputs[2])
    both.inputs[0].default_value = part
    for link in list(shader.outputs["BSDF"].links):
        links.new(both.outputs[0], link.to_socket)
    links.new(shader.outputs["BSDF"], both.inputs[1])
    links.new(cut_out.outputs[0], both.inputs[2])
    for i, node in enumerate((tint, bright, through, clear, cut_out, both)):
        node.location = (shader.location.x + 60 * i, shader.location.y - 420 - 120 * i)


# ---- land ----

# Metres between creases of rock, from gullies to blocks, and how much each size counts.
CREASES = ((60.0, 0.5), (14.0, 0.5))
# The same of what grows on the rest, from patches to tufts.
TUFTS = ((23.0, 0.35), (4.0, 0.35), (0.9, 0.3))


def land_group():
    """Colour and normal of the land → the same, creased where it is steep and not green, and tufted elsewhere but on sand and snow.

    The file's colours are a metre apart, and beyond the field 64: slopes are smooth without."""
    name = f"{TITLE} land"
    group = bpy.data.node_groups.get(name)
    if group:
        return group
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Color", in_out=in_out, socket_type="NodeSocketColor")
        group.interface.new_socket("Normal", in_out=in_out, socket_type="NodeSocketVector")
    nodes, links = group.nodes, group.links
    inputs, outputs = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    place = nodes.new("ShaderNodeTexCoord").outputs["Object"]
    up = nodes.new("ShaderNodeSeparateXYZ")
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Normal"], up.inputs[0])
    steep = map_range(group, up.outputs["Z"], (0.86, 0.66), (0.0, 1.0))
    rgb = nodes.new("ShaderNodeSeparateColor")
    links.new(inputs.outputs["Color"], rgb.inputs[0])
    greener = math_node(group, "DIVIDE", rgb.outputs["Green"], math_node(group, "MAXIMUM", rgb.outputs["Red"], 1e-3))
    rocky = math_node(group, "MULTIPLY", steep, map_range(group, greener, (1.02, 1.18), (1.0, 0.0)))
    # Sand and snow are brighter than anything that grows.
    turfy = math_node(group, "MULTIPLY", math_node(group, "SUBTRACT", 1.0, rocky), map_range(group, rgb.outputs["Green"], (0.2, 0.32), (1.0, 0.0)))
    creases, tufts = 0.0, 0.0
    for size_m, weight in CREASES:
        away = math_node(group, "ABSOLUTE", math_node(group, "SUBTRACT", noise(group, place, size_m, 7.0), 0.5))
        # A crease where the noise passes its middle.
        creases = math_node(group, "ADD", creases, map_range(group, away, (0.0, 0.16), (0.0, weight)))
    for size_m, weight in TUFTS:
        tufts = math_node(group, "ADD", tufts, map_range(group, noise(group, place, size_m, 3.0), (0.25, 0.75), (0.0, weight)))
    color, normal = inputs.outputs["Color"], inputs.outputs["Normal"]
    for height, where, distance_m, tones in ((creases, rocky, 2.5, (0.55, 1.15)), (tufts, turfy, 0.5, (0.6, 1.4))):
        bump, tone = nodes.new("ShaderNodeBump"), nodes.new("ShaderNodeMixRGB")
        bump.inputs["Distance"].default_value = distance_m
        links.new(where, bump.inputs["Strength"])
        links.new(height, bump.inputs["Height"])
        links.new(normal, bump.inputs["Normal"])
        tone.blend_type = "MULTIPLY"
        links.new(where, tone.inputs["Fac"])
        links.new(color, tone.inputs["Color1"])
        links.new(map_range(group, height, (0.0, 1.0), tones), tone.inputs["Color2"])
        color, normal = tone.outputs[0], bump.outputs[0]
    links.new(color, outputs.inputs["Color"])
    links.new(normal, outputs.inputs["Normal"])
    return group


def noise(group, place, size_m, detail):
    """About 0.5, with features so large and finer ones."""
    node = group.nodes.new("ShaderNodeTexNoise")
    for name, number in (("Scale", 1.0 / size_m), ("Detail", detail), ("Roughness", 0.62), ("Distortion", 0.4)):
        node.inputs[name].default_value = number
    group.links.new(place, node.inputs["Vector"])
    return node.outputs[0]


def roughen_land(material):
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = principled(material)
    is_land = material.name.split(".")[0] in ("ground", "apron")
    if not is_land or not shader or any(n.type == "GROUP" and n.node_tree == land_group() for n in nodes):
        return
    land = nodes.new("ShaderNodeGroup")
    land.node_tree = land_group()
    land.location = (shader.location.x - 200, shader.location.y)
    if shader.inputs["Normal"].links:
        links.new(shader.inputs["Normal"].links[0].from_socket, land.inputs["Normal"])
    else:
        links.new(nodes.new("ShaderNodeNewGeometry").outputs["Normal"], land.inputs["Normal"])
    color = shader.inputs["Base Color"]
    if color.links:
        links.new(color.links[0].from_socket, land.inputs["Color"])
    else:
        land.inputs["Color"].default_value = color.default_value
    links.new(land.outputs["Color"], color)
    links.new(land.outputs["Normal"], shader.inputs["Normal"])


def map_range(group, value, range_in, range_out):
    node = group.nodes.new("ShaderNodeMapRange")
    node.interpolation_type = "SMOOTHSTEP"
    for socket, number in zip(list(node.inputs)[1:5], (*range_in, *range_out)):
        socket.default_value = number
    group.links.new(value, node.inputs["Value"])
    return node.outputs["Result"]


# ---- haze ----

def haze_group():
    """A shader, and the part of it that is not transparent → the same behind the air of its distance.

    In materials and not in the world: a volume of many kilometres takes Cycles hours, and Eevee cuts it into slices."""
    name = f"{TITLE} haze"
    group = bpy.data.node_groups.get(name)
    if group:
        return group
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    group.interface.new_socket("Shader", in_out="INPUT", socket_type="NodeSocketShader")
    alpha = group.interface.new_socket("Alpha", in_out="INPUT", socket_type="NodeSocketFloat")
    alpha.default_value = 1.0
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    inputs, outputs = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    distance_m = group.nodes.new("ShaderNodeCameraData").outputs["View Distance"]
    clear = math_node(group, "EXPONENT", math_node(group, "MULTIPLY", distance_m, -SETTINGS["haze_extinction_per_m"]))
    hazy = math_node(group, "MULTIPLY", math_node(group, "SUBTRACT", 1.0, clear), inputs.outputs["Alpha"])
    seen = math_node(group, "MULTIPLY", hazy, group.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"])
    air = group.nodes.new("ShaderNodeEmission")
    group.links.new(horizon_behind(group), air.inputs["Color"])
    air.inputs["Strength"].default_value = SETTINGS["sky_strength"]
    mix = group.nodes.new("ShaderNodeMixShader")
    group.links.new(seen, mix.inputs[0])
    group.links.new(inputs.outputs["Shader"], mix.inputs[1])
    group.links.new(air.outputs[0], mix.inputs[2])
    group.links.new(mix.outputs[0], outputs.inputs["Shader"])
    return group


def horizon_behind(group):
    """The sky just below the horizon, where there are no clouds, in the direction in which one looks: air glows towards the sun."""
    environment, mapping = sky_nodes(group.nodes)
    # Towards the eye → away from it, and level.
    mapping.inputs["Scale"].default_value = (-1, -1, 0)
    level, below = group.nodes.new("ShaderNodeVectorMath"), group.nodes.new("ShaderNodeVectorMath")
    level.operation, below.operation = "NORMALIZE", "ADD"
    below.inputs[1].default_value = (0, 0, -0.003)
    group.links.new(group.nodes.new("ShaderNodeNewGeometry").outputs["Incoming"], mapping.inputs["Vector"])
    group.links.new(mapping.outputs["Vector"], level.inputs[0])
    group.links.new(level.outputs["Vector"], below.inputs[0])
    group.links.new(below.outputs["Vector"], environment.inputs["Vector"])
    return environment.outputs["Color"]


def math_node(group, operation, *values):
    """Of sockets and numbers."""
    node = group.nodes.new("ShaderNodeMath")
    node.operation = operation
    for socket, value in zip(node.inputs, values):
        if hasattr(value, "links"):
            group.links.new(value, socket)
        else:
            socket.default_value = value
    return node.outputs[0]


def add_haze(material):
    nodes, links = material.node_tree.nodes, material.node_tree.links
    output = next((n for n in nodes if n.type == "OUTPUT_MATERIAL" and n.is_active_output), None)
    surface = output and output.inputs["Surface"].links
    if not surface or any(n.type == "GROUP" and n.node_tree == haze_group() for n in nodes):
        return
    haze = nodes.new("ShaderNodeGroup")
    haze.node_tree = haze_group()
    haze.location = (output.location.x, output.location.y + 200)
    shader = principled(material)
    alpha = shader and shader.inputs["Alpha"].links
    if alpha:
        links.new(alpha[0].from_socket, haze.inputs["Alpha"])
    else:
        haze.inputs["Alpha"].default_value = 1.0
    links.new(surface[0].from_socket, haze.inputs["Shader"])
    links.new(haze.outputs["Shader"], output.inputs["Surface"])
    if hasattr(material, "cycles"):
        material.cycles.emission_sampling = "NONE"  # air is no lamp


def set_view():
    scene = bpy.context.scene
    scene.view_settings.view_transform, scene.view_settings.look = "AgX", "None"
    scene.view_settings.exposure, scene.view_settings.gamma = 0.0, 1.0
    if hasattr(scene, "cycles"):
        scene.cycles.transparent_max_bounces = max(scene.cycles.transparent_max_bounces, TRANSPARENT_BOUNCES)


main()
