"""Run by Blender's Python: open files and print, for each, what Blender has of it, as one line of JSON."""

import json
import sys

import bpy
from mathutils import Vector

READERS = {
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "usdz": lambda path: bpy.ops.wm.usd_import(filepath=path),
}


def read(path: str) -> dict:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    try:
        READERS[path.rsplit(".", 1)[1]](path)
    except RuntimeError as refused:
        return {"refused": str(refused).strip()}
    bpy.context.view_layer.update()
    shapes = {bone.custom_shape for thing in bpy.data.objects if thing.pose for bone in thing.pose.bones}
    meshes = [thing for thing in bpy.data.objects if thing.type == "MESH" and thing not in shapes]
    return {
        "meshes": [told(thing) for thing in meshes],
        "box": box(meshes),
        "materials": {one.name: shaded(one) for one in bpy.data.materials},
        "bones": sum(len(one.bones) for one in bpy.data.armatures),
        "actions": sorted(one.name for one in bpy.data.actions),
    }


def told(thing: bpy.types.Object) -> dict:
    mesh = thing.data
    return {
        "triangles": len(mesh.polygons),
        "uvs": len(mesh.uv_layers),
        "colours": len(mesh.color_attributes),
        "material": thing.material_slots[0].material.name if thing.material_slots else "",
        "skinned": any(one.type == "ARMATURE" for one in thing.modifiers),
    }


def shaded(material: bpy.types.Material) -> dict:
    nodes = material.node_tree.nodes
    principled = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    return {
        "pictures": sorted(node.image.size[0] for node in nodes if node.type == "TEX_IMAGE" and node.image),
        "coloured": principled.inputs["Base Color"].is_linked,
        "cut": principled.inputs["Alpha"].is_linked,
        "relief": principled.inputs["Normal"].is_linked,
        "transmission": principled.inputs["Transmission Weight"].default_value,
    }


def box(meshes: list) -> list:
    corners = [thing.matrix_world @ Vector(corner) for thing in meshes for corner in thing.bound_box]
    return [[pick(corner[axis] for corner in corners) for axis in range(3)] for pick in (min, max)]


if __name__ == "__main__":
    for name in sys.argv[1:]:
        sys.stdout.write(f"READ {json.dumps(read(name))}\n")
