"""The kitchen of `kitchen_prefs.rendering` as one binary glTF file, for the page's third dimension.

The file's first scene is the kitchen with everything in and closed; the second one is a shelf of
dishes, one of each category, in their own frames. What moves, and how far, stands in the nodes'
extras, as do the placements and the dishes' colours:

    kitchen   sink (3,) m, counter z m, placements (P, 7) in a rack's frame, wxyz
    door      opened, radians about x
    racks     travel, m towards -y
    a dish    colours, RGB as on a screen or RGBA, one for each number that a dish has in a session

The kitchen's z is up and glTF's is not: the node "kitchen" turns it.
"""

from collections import defaultdict
from math import sqrt

import mujoco
import numpy as np
from PIL import Image

from kitchen_prefs.physics.dish_bodies import COLLISION_GROUP
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.rendering.dishwasher import rack_joint
from kitchen_prefs.rendering.kitchen_model import Quality, kitchen_spec
from kitchen_prefs.rendering.meshes import Surface, box, joined, tube, turned
from kitchen_prefs.rendering.parts import MATERIALS, TEXTURED
from kitchen_prefs.rendering.tableware import GLAZES, TRAY_MATERIAL, colour, surface
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.placements import load_placements
from kitchen_prefs_demonstrations.page.glb_writing import GlbWriter

DISH_SIDES = 36  # facets round a dish: none is seen at the nearest that the camera goes
BAR_SIDES = 6  # facets round a wire or a handle, of which there are 200
TEXTURE_SIDE = 512  # pixels: half of what the renderer takes, a quarter of the file
DISHES = 20  # the most that a session has; each number has its colour
WIRE = "wire"  # the racks' geoms have a colour and no material
METALS = {"steel": 0.35, "basin": 0.3, "liner": 0.2, "door inside": 0.2}  # glTF's metalness
# x to the right, y into the wall, z up: a quarter turn about x makes y up and z to the viewer.
Z_UP = [-sqrt(0.5), 0.0, 0.0, sqrt(0.5)]  # xyzw, as glTF has quaternions


def kitchen_glb() -> bytes:
    """The kitchen as the bytes of a .glb file; needs the extra `scene`."""
    spec = kitchen_spec(Quality(samples=0, shadows=0, sides=DISH_SIDES // 2))
    writer = GlbWriter()
    materials = _materials(writer, spec)
    writer.add_scene("kitchen", [_kitchen(writer, spec, materials)])
    dishes = [_dish(writer, category, materials) for category in CATEGORIES]
    writer.add_scene("tableware", dishes)
    return writer.file()


def _materials(writer: GlbWriter, spec: mujoco.MjSpec) -> dict[str, int]:
    """The furniture's materials by name."""
    numbers = {
        name: writer.add_material((*rgb, 1.0), _roughness(shininess), METALS.get(name, 0.0))
        for name, (rgb, _, shininess) in MATERIALS.items()
    }
    for name, (_, _, _, shininess) in TEXTURED.items():
        drawn = spec.texture(name)
        image = Image.frombytes("RGB", (drawn.width, drawn.height), drawn.data)
        texture = writer.add_texture(image.resize((TEXTURE_SIDE, TEXTURE_SIDE)))
        white = (1.0, 1.0, 1.0, 1.0)
        numbers[name] = writer.add_material(white, _roughness(shininess), 0.0, texture)
    numbers[WIRE] = writer.add_material((0.92, 0.93, 0.94, 1.0), 0.35)
    return numbers


def _roughness(shininess: float) -> float:
    return 1.0 - 0.8 * shininess


def _kitchen(writer: GlbWriter, spec: mujoco.MjSpec, materials: dict[str, int]) -> int:
    def mesh(body: mujoco.MjsBody) -> int:
        parts = _surfaces(spec, body)
        return writer.add_mesh({materials[name]: surface for name, surface in parts.items()})

    room = writer.add_node("room", mesh=mesh(spec.worldbody))
    door = writer.add_node(
        "door",
        mesh=mesh(spec.body("door")),
        translation=layout.DOOR_HINGE,
        extras={"opened": layout.DOOR_OPEN_ANGLE},
    )
    wires = mesh(spec.body(rack_joint(RACKS[0])))  # both racks are alike
    racks = [
        writer.add_node(
            rack,
            mesh=wires,
            translation=layout.RACK_CLOSED[rack],
            extras={"travel": layout.RACK_TRAVEL},
        )
        for rack in RACKS
    ]
    placements = load_placements()
    poses = np.hstack([placements.position, placements.quaternion])  # (P, 7)
    extras = {
        "sink": layout.SINK_POSITION,
        "counter": layout.COUNTER_HEIGHT,
        "placements": poses.astype(float).round(4).tolist(),
    }
    return writer.add_node("kitchen", rotation=Z_UP, children=[room, door, *racks], extras=extras)


def _dish(writer: GlbWriter, category: str, materials: dict[str, int]) -> int:
    """One dish of a category, white; a page gives it the colour of its number."""
    if category == "tray":
        material = materials[TRAY_MATERIAL]
    else:
        white = (1.0, 1.0, 1.0, colour(category, 0)[3])
        material = writer.add_material(white, _roughness(GLAZES[category].shininess))
    mesh = writer.add_mesh({material: surface(category, DISH_SIDES)})
    colours = [colour(category, number) for number in range(DISHES)]
    return writer.add_node(category, mesh=mesh, extras={"colours": colours})


def _surfaces(spec: mujoco.MjSpec, body: mujoco.MjsBody) -> dict[str, Surface]:
    """What is seen of a body, by material, in the body's frame."""
    surfaces = defaultdict(list)
    for geom in body.geoms:
        if geom.group != COLLISION_GROUP:
            surfaces[geom.material or WIRE].append(_surface(spec, geom))
    return {material: joined(of_material) for material, of_material in surfaces.items()}


def _surface(spec: mujoco.MjSpec, geom: mujoco.MjsGeom) -> Surface:
    if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = spec.mesh(geom.meshname)
        texture = np.reshape(mesh.usertexcoord, (-1, 2))
        return Surface(
            np.reshape(mesh.uservert, (-1, 3)),
            np.reshape(mesh.userface, (-1, 3)),
            texture if len(texture) else None,
        )
    if geom.type == mujoco.mjtGeom.mjGEOM_BOX:
        corners = box(geom.pos - geom.size, geom.pos + geom.size)
        return Surface(corners.vertices, corners.faces)  # boxes have one colour
    radius, half = geom.size[:2]
    if geom.type == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return tube(np.reshape(geom.fromto, (2, 3)), radius, BAR_SIDES)
    outline = np.array([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])
    cylinder = turned(outline, DISH_SIDES)
    return Surface(cylinder.vertices + geom.pos, cylinder.faces)
