#!/usr/bin/env python3
"""Writes the models beside it with public exporters: Blender's (`bpy`), trimesh's and pygltflib's.

    pip install bpy==5.0.1 trimesh==5.2.0 pygltflib==1.16.5 && python3 make.py

Run once; the files are committed. Lengths are metres; what the tests expect of each is written where it is made.
"""

import base64
import os

import bpy
import numpy
import trimesh

HERE = os.path.dirname(os.path.abspath(__file__))


def path(name):
    return os.path.join(HERE, name)


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def material(name, **inputs):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    principled = made.node_tree.nodes["Principled BSDF"]
    for key, value in inputs.items():
        principled.inputs[key.replace("_", " ")].default_value = value
    return made


def cube(name, at, size, made, parent=None):
    bpy.ops.mesh.primitive_cube_add(size=size, location=at)
    cube = bpy.context.object
    cube.name = name
    cube.data.materials.append(made)
    cube.parent = parent
    return cube


def camera(at, turn=(0, 0, 0), angle=1.0):
    """Looks down Blender's -z, unturned."""
    lens = bpy.data.cameras.new("Eye")
    lens.angle = angle
    eye = bpy.data.objects.new("Eye", lens)
    eye.location, eye.rotation_euler = at, turn
    bpy.context.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def lamp(kind, at, energy, turn=(0, 0, 0), color=(1, 1, 1)):
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy, data.color = energy, color
    made = bpy.data.objects.new(kind.title(), data)
    made.location, made.rotation_euler = at, turn
    bpy.context.collection.objects.link(made)


def gltf(name, format="GLTF_SEPARATE", **more):
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 4, 3
    bpy.ops.export_scene.gltf(
        filepath=path(name), export_format=format, export_cameras=True, export_lights=True, export_yup=True,
        export_import_convert_lighting_mode="RAW", **more)


def nested():
    """Blender, .gltf + .bin: a red cube under two turned and scaled parents, a green one, a camera, a sun."""
    empty()
    top = bpy.data.objects.new("Top", None)
    top.location, top.rotation_euler = (2, 0, 0), (0, 0, numpy.pi / 2)
    arm = bpy.data.objects.new("Arm", None)
    arm.location, arm.scale, arm.parent = (0, 1, 0), (2, 1, 0.5), top
    for node in (top, arm):
        bpy.context.collection.objects.link(node)
    cube("Red", (0, 0, 0), 1, material("Red", Base_Color=(0.8, 0.05, 0.05, 1), Roughness=1), arm)
    cube("Green", (-1.5, 0, 0), 1, material("Green", Base_Color=(0.05, 0.8, 0.05, 1), Roughness=1))
    camera((0, 0, 8))
    lamp("SUN", (0, 0, 5), 3)
    gltf("nested.gltf")


def metals():
    """Blender, GLB: a smooth silver, a rough gold and a half metallic ball, unlit, without a camera."""
    empty()
    for i, (name, color, metallic, roughness) in enumerate([
            ("Silver", (0.95, 0.93, 0.88, 1), 1, 0), ("Gold", (1, 0.77, 0.34, 1), 1, 0.4),
            ("Half", (0.3, 0.5, 0.9, 1), 0.5, 0.3)]):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.9, location=(2 * i, 0, 0))
        bpy.context.object.name = name
        bpy.context.object.data.materials.append(
            material(name, Base_Color=color, Metallic=metallic, Roughness=roughness))
    gltf("metals.glb", "GLB")


def glass():
    """Blender, GLB: a pane of water, a frosted one, and a lamp by emissive strength behind."""
    empty()
    cube("Clear", (-0.7, 0, 0), 1, material("Clear", Base_Color=(1, 1, 1, 1), Transmission_Weight=1, IOR=1.33,
                                            Roughness=0))
    cube("Frosted", (0.7, 0, 0), 1, material("Frosted", Base_Color=(0.5, 0.9, 0.6, 1), Transmission_Weight=1, IOR=1.5,
                                             Roughness=0.5))
    cube("Lamp", (0, 0, -3), 2, material("Lamp", Base_Color=(0, 0, 0, 1), Emission_Color=(1, 0.5, 0.25, 1),
                                         Emission_Strength=8))
    camera((0, 0, 6), angle=0.7)
    gltf("glass.glb", "GLB")


def lights():
    """Blender, GLB: a white floor under a red point, a spot and a sun; the camera looks straight down."""
    empty()
    bpy.ops.mesh.primitive_plane_add(size=4)
    bpy.context.object.name = "Floor"
    bpy.context.object.data.materials.append(material("Floor", Base_Color=(0.5, 0.5, 0.5, 1), Roughness=1))
    lamp("POINT", (-1, 0, 1), 40, color=(1, 0, 0))
    lamp("SPOT", (1, 0, 1), 40, color=(0, 1, 0))
    lamp("SUN", (0, 0, 5), 0.5, color=(0, 0, 1))
    camera((0, 0, 5))
    gltf("lights.glb", "GLB")


def textured():
    """trimesh, GLB: a square with a texture, half orange and half black, whose mean light is half of the orange."""
    from PIL import Image
    picture = Image.new("RGB", (8, 8), (0, 0, 0))
    picture.paste((255, 188, 0), (0, 0, 4, 8))
    square = trimesh.Trimesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    look = trimesh.visual.material.PBRMaterial(name="Board", baseColorTexture=picture, metallicFactor=0,
                                               roughnessFactor=1)
    square.visual = trimesh.visual.TextureVisuals(uv=[[0, 0], [1, 0], [1, 1], [0, 1]], material=look)
    square.export(path("textured.glb"))


def strips():
    """pygltflib, .gltf with its data in it: a strip and a fan of four corners, mirrored by their node, sparse."""
    import pygltflib as g
    points = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 0, 0], [3, 0, 0], [3, 1, 0], [2, 1, 0]],
                         numpy.float32)
    moved = numpy.array([[3, 1, 0.5]], numpy.float32)
    order = numpy.array([4, 5, 6, 7], numpy.uint8)
    data = points.tobytes() + moved.tobytes() + order.tobytes() + bytes([6, 0, 0, 0])  # the sparse item is the seventh vertex
    model = g.GLTF2(
        asset=g.Asset(generator="pygltflib"), scene=0, scenes=[g.Scene(nodes=[0])],
        nodes=[g.Node(name="Mirror", scale=[-2, 1, 1], translation=[0, 0, -1], children=[1]),
               g.Node(name="Pair", mesh=0)],
        meshes=[g.Mesh(primitives=[
            g.Primitive(attributes=g.Attributes(POSITION=0), mode=5, material=0),
            g.Primitive(attributes=g.Attributes(POSITION=1), indices=2, mode=6, material=1)])],
        materials=[g.Material(name="A", pbrMetallicRoughness=g.PbrMetallicRoughness(
            baseColorFactor=[0.2, 0.4, 0.6, 1], metallicFactor=0)),
            g.Material(name="B", emissiveFactor=[1, 0.5, 0], extensions={
                "KHR_materials_emissive_strength": {"emissiveStrength": 4}})],
        extensionsUsed=["KHR_materials_emissive_strength"],
        accessors=[
            g.Accessor(bufferView=0, componentType=5126, count=4, type="VEC3", min=[0, 0, 0], max=[1, 1, 0]),
            g.Accessor(bufferView=0, componentType=5126, count=8, type="VEC3", min=[0, 0, 0], max=[3, 1, 0.5],
                       sparse=g.Sparse(count=1, indices=g.AccessorSparseIndices(bufferView=3,
                                                                                       componentType=5121),
                                               values=g.AccessorSparseValues(bufferView=1))),
            g.Accessor(bufferView=2, componentType=5121, count=4, type="SCALAR")],
        bufferViews=[g.BufferView(buffer=0, byteLength=96), g.BufferView(buffer=0, byteOffset=96, byteLength=12),
                     g.BufferView(buffer=0, byteOffset=108, byteLength=4),
                     g.BufferView(buffer=0, byteOffset=112, byteLength=4)],
        buffers=[g.Buffer(byteLength=len(data),
                          uri="data:application/octet-stream;base64," + base64.b64encode(data).decode())])
    model.save(path("strips.gltf"))


for make in (nested, metals, glass, lights, textured, strips):
    make()
