"""Binary glTF 2.0: surfaces of triangles with materials, in one file that three.js reads.

Normals take one byte a coordinate (the extension KHR_mesh_quantization); all else is plain glTF.
"""

import io
import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from PIL import Image

from kitchen_prefs.rendering.meshes import Surface

FLOAT, BYTE, UNSIGNED_SHORT = 5126, 5120, 5123  # the format's numbers of component types
VERTICES, FACES = 34962, 34963  # and of what a buffer holds
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942
JPEG_QUALITY = 82


class GlbWriter:
    """Collects what a file holds; every `add_` returns the number by which others refer to it."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self._lists: dict[str, list[Any]] = {}

    def add_texture(self, image: Image.Image) -> int:
        """A picture that repeats."""
        file = io.BytesIO()
        image.save(file, "JPEG", quality=JPEG_QUALITY)
        source = self._add(
            "images", {"bufferView": self._view(file.getvalue()), "mimeType": "image/jpeg"}
        )
        return self._add("textures", {"source": source})

    def add_material(
        self,
        colour: Sequence[float],
        roughness: float,
        metalness: float = 0.0,
        texture: int | None = None,
    ) -> int:
        """A material of a colour, RGBA as on a screen, that its texture multiplies."""
        red, green, blue, alpha = colour
        surface: dict[str, Any] = {
            "baseColorFactor": [*(round(_linear(c), 4) for c in (red, green, blue)), alpha],
            "roughnessFactor": round(roughness, 3),
            "metallicFactor": metalness,
        }
        if texture is not None:
            surface["baseColorTexture"] = {"index": texture}
        blend = {"alphaMode": "BLEND"} if alpha < 1 else {}
        return self._add("materials", {"pbrMetallicRoughness": surface, **blend})

    def add_mesh(self, parts: Mapping[int, Surface]) -> int:
        """A mesh of surfaces by the numbers of their materials."""
        primitives = []
        for material, surface in parts.items():
            attributes = {
                "POSITION": self._vertices(surface.vertices.astype(np.float32)),
                "NORMAL": self._vertices(_quantised(_normals(surface)), normalized=True),
            }
            if surface.texture is not None:
                flipped = surface.texture * (1, -1)  # glTF counts a picture's rows from above
                attributes["TEXCOORD_0"] = self._vertices(flipped.astype(np.float32))
            faces = self._faces(surface.faces.astype(np.uint16))
            primitives.append({"attributes": attributes, "indices": faces, "material": material})
        return self._add("meshes", {"primitives": primitives})

    def add_node(self, name: str, **properties: Any) -> int:
        """A node with glTF's own properties: mesh, children, translation, rotation, extras."""
        return self._add("nodes", {"name": name, **properties})

    def add_scene(self, name: str, nodes: Sequence[int]) -> int:
        """A scene of nodes; the first one is what a viewer shows."""
        return self._add("scenes", {"name": name, "nodes": list(nodes)})

    def file(self) -> bytes:
        """The whole file."""
        content = {
            "asset": {"version": "2.0", "generator": "kitchen_prefs"},
            "extensionsUsed": ["KHR_mesh_quantization"],
            "extensionsRequired": ["KHR_mesh_quantization"],
            "scene": 0,
            "buffers": [{"byteLength": len(self._binary)}],
            **self._lists,
        }
        text = json.dumps(content, separators=(",", ":"), allow_nan=False).encode()
        chunks = _chunk(JSON_CHUNK, text, b" ") + _chunk(BINARY_CHUNK, bytes(self._binary), b"\0")
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _add(self, kind: str, thing: Any) -> int:
        self._lists.setdefault(kind, []).append(thing)
        return len(self._lists[kind]) - 1

    def _vertices(self, values: np.ndarray, **properties: bool) -> int:
        """Numbers of each vertex, (V, k) float32 or int8."""
        accessor: dict[str, Any] = {
            "type": f"VEC{values.shape[1]}",
            "componentType": BYTE if values.dtype == np.int8 else FLOAT,
            "count": len(values),
            "min": values.min(axis=0).tolist(),
            "max": values.max(axis=0).tolist(),
        }
        row = values.shape[1] * values.itemsize
        filler = -row % 4 // values.itemsize  # a vertex's numbers begin at a whole word
        content = np.pad(values, ((0, 0), (0, filler))).tobytes()
        view = self._view(content, byteStride=row + -row % 4, target=VERTICES)
        return self._add("accessors", accessor | properties | {"bufferView": view})

    def _faces(self, corners: np.ndarray) -> int:
        """The vertices of each triangle, (F, 3) uint16."""
        view = self._view(corners.tobytes(), target=FACES)
        accessor = {"type": "SCALAR", "componentType": UNSIGNED_SHORT, "count": corners.size}
        return self._add("accessors", accessor | {"bufferView": view})

    def _view(self, content: bytes, **properties: int) -> int:
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(content)}
        self._binary += content + b"\0" * (-len(content) % 4)
        return self._add("bufferViews", view | properties)


def _normals(surface: Surface) -> np.ndarray:
    """The mean direction of the faces round each vertex, by their areas, (V, 3)."""
    corners = surface.vertices[surface.faces]  # (F, 3, 3)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])  # (F, 3)
    total = np.zeros_like(surface.vertices)
    np.add.at(total, surface.faces, across[:, None])
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)


def _quantised(directions: np.ndarray) -> np.ndarray:
    return np.round(127 * directions).astype(np.int8)


def _linear(value: float) -> float:
    """A screen's brightness as an amount of light, sRGB's formula."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def _chunk(kind: int, content: bytes, filler: bytes) -> bytes:
    padded = content + filler * (-len(content) % 4)
    return struct.pack("<II", len(padded), kind) + padded
