"""The kitchen's glTF file: what it holds, and how large all of the third dimension is."""

import base64
import io
import json
import struct

import numpy as np
import pytest
from PIL import Image

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.tableware import colour
from kitchen_prefs.simulation.layout import EXTENTS, RACK_TRAVEL
from kitchen_prefs.simulation.placements import load_placements
from kitchen_prefs.web.page import joined
from kitchen_prefs_demonstrations.page.building import THREE, THREE_SCRIPTS
from kitchen_prefs_demonstrations.page.kitchen_gltf import kitchen_glb

SMALL_ENOUGH = 2_000_000  # bytes of everything that the third dimension adds to the page


@pytest.fixture(scope="module")
def glb():
    """The kitchen's file."""
    return kitchen_glb()


@pytest.fixture(scope="module")
def content(glb):
    """What the file says of itself."""
    length = struct.unpack_from("<I", glb, 12)[0]
    return json.loads(glb[20 : 20 + length])


def node(content, name):
    return next(one for one in content["nodes"] if one["name"] == name)


def test_a_dish_has_its_extents(content):
    for category in CATEGORIES:
        (part,) = content["meshes"][node(content, category)["mesh"]]["primitives"]
        bounds = content["accessors"][part["attributes"]["POSITION"]]
        size = np.subtract(bounds["max"], bounds["min"])
        np.testing.assert_allclose(size, EXTENTS[category], atol=0.004)


def test_the_file_says_where_dishes_stand_and_what_moves(content):
    placements = load_placements()
    poses = np.array(node(content, "kitchen")["extras"]["placements"])
    np.testing.assert_allclose(poses[:, :3], placements.position, atol=1e-4)
    np.testing.assert_allclose(poses[:, 3:], placements.quaternion, atol=1e-4)
    assert node(content, "top")["extras"] == {"travel": RACK_TRAVEL}
    assert node(content, "cup")["extras"]["colours"][4] == list(colour("cup", 4))


def test_everything_lies_within_the_file(content, glb):
    binary = glb[28 + struct.unpack_from("<I", glb, 12)[0] :]
    views = content["bufferViews"]
    assert all(view["byteOffset"] + view["byteLength"] <= len(binary) for view in views)
    for accessor in content["accessors"]:
        view = views[accessor["bufferView"]]
        assert accessor["count"] * view.get("byteStride", 2) == view["byteLength"]
    assert len(glb) == struct.unpack_from("<I", glb, 8)[0]
    for image in content["images"]:
        view = views[image["bufferView"]]
        start, length = view["byteOffset"], view["byteLength"]
        assert Image.open(io.BytesIO(binary[start : start + length])).size == (512, 512)


def test_the_third_dimension_is_small(glb):
    scripts = joined(*(THREE / name for name in (*THREE_SCRIPTS, "kitchen3d.css")))
    assert len(scripts.encode()) + len(base64.b64encode(glb)) < SMALL_ENOUGH
    assert "</script" not in scripts.lower()
    assert "<!--" not in scripts
