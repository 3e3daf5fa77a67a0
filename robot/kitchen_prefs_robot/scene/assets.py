"""The arm's model file in the installed package gym-hil, with meshes of fewer triangles.

The package is not imported, because that would register its environments. Its meshes are simplified
when they are first used and kept in the user's cache; none of them is part of this project.
"""

import os
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import fast_simplification
import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.utils.files import atomic_file

KEPT = 0.12  # of a mesh's triangles; the arm has 190,000, which no picture of it needs
FEWEST = 400  # triangles: smaller meshes stay as they are


def arm_spec() -> mujoco.MjSpec:
    """The Panda with a Robotiq 2F-85 gripper, with simplified meshes.

    Raises:
        OSError: If gym-hil is not installed, or its arm is not where it was.
    """
    path = _model_file()
    spec = mujoco.MjSpec.from_file(str(path))
    with np.load(_simplified_meshes(path), allow_pickle=False) as meshes:
        for mesh in spec.meshes:
            mesh.name = mesh.name or Path(mesh.file).stem  # MuJoCo 3 names them when it compiles
            _replace(mesh, meshes[f"{mesh.name} vertices"], meshes[f"{mesh.name} faces"])
    return spec


def _model_file() -> Path:
    package = find_spec("gym_hil")
    if package is None or not package.submodule_search_locations:
        raise OSError(
            "The robot needs its arm: `pip install 'lerobot_policy_kitchen_prefs[robot]'`. "
            "Everything else works without it."
        )
    path = Path(package.submodule_search_locations[0]) / "assets" / "panda.xml"
    if not path.is_file():
        raise OSError(f"gym-hil has no {path.name} any more; install gym-hil 0.1.14.")
    return path


def _simplified_meshes(path: Path) -> Path:
    """The file of all meshes of a model, written at the first call."""
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    kept = caches / "kitchen_prefs" / f"panda-of-gym-hil-{version('gym-hil')}.npz"
    if not kept.is_file():
        kept.parent.mkdir(parents=True, exist_ok=True)
        with atomic_file(kept) as unfinished, unfinished.open("wb") as file:
            meshes = _simplify(mujoco.MjModel.from_xml_path(str(path)))
            np.savez_compressed(file, allow_pickle=False, **meshes)
    return kept


def _simplify(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """The vertices, (n, 3) float32, and triangles, (m, 3) int32, of each mesh by its name."""
    simplified: dict[str, np.ndarray] = {}
    for number in range(model.nmesh):
        mesh = model.mesh(number)
        first, count = mesh.vertadr[0], mesh.vertnum[0]
        vertices = model.mesh_vert[first : first + count]
        first, count = mesh.faceadr[0], mesh.facenum[0]
        faces = model.mesh_face[first : first + count]
        vertices, faces = _merged(vertices, faces)
        if len(faces) > FEWEST:
            share = max(KEPT, FEWEST / len(faces))
            vertices, faces = fast_simplification.simplify(vertices, faces, 1.0 - share)
        # MuJoCo has moved the mesh into its axes of inertia.
        turn = Rotation.from_quat(model.mesh_quat[number], scalar_first=True)
        vertices = turn.apply(vertices) + model.mesh_pos[number]
        simplified[f"{mesh.name} vertices"] = vertices.astype(np.float32)
        simplified[f"{mesh.name} faces"] = faces.astype(np.int32)
    return simplified


def _merged(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A mesh whose vertices at one place are one: the files repeat them for every triangle."""
    unique, index = np.unique(vertices, axis=0, return_inverse=True)
    return unique, index.reshape(-1)[faces]


def _replace(mesh: mujoco.MjsMesh, vertices: np.ndarray, faces: np.ndarray) -> None:
    mesh.file = ""
    mesh.scale = (1.0, 1.0, 1.0)  # the compiled vertices are in metres
    mesh.uservert = vertices.ravel()
    mesh.userface = faces.ravel()
