"""The page on which a visitor shows once how the dishwasher is loaded, as one HTML file."""

import base64
from importlib.resources import files
from importlib.util import find_spec
from typing import Any

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.instances import PROMPT_CAPACITY
from kitchen_prefs.simulation.sessions import Session, make_session
from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs.web.kitchen_data import layout_data
from kitchen_prefs.web.page import SHARED, joined, self_contained_page
from kitchen_prefs_demonstrations.kitchens import page_sessions, study_session
from kitchen_prefs_demonstrations.page.observation_data import observed_kitchen, observed_session
from kitchen_prefs_demonstrations.page.policy_data import policy_data, policy_script
from kitchen_prefs_experiments.checkpoints import find_checkpoint

TEMPLATES = files("kitchen_prefs_demonstrations.page") / "templates"
THREE = files("kitchen_prefs_demonstrations.page") / "three"
SHARED_SCRIPTS = ("basics.js", "kitchen.js", "replay.js", "drawing.js")
THREE_SCRIPTS = (
    "three.min.js",
    "model3d.js",
    "stage3d.js",
    "motion3d.js",
    "picking3d.js",
    "hints3d.js",
    "kitchen3d.js",
)
SCRIPTS = (
    "kitchens.js",
    "study.js",
    "choices.js",
    "stage.js",
    "implied.js",
    "keeping.js",
    "three_view.js",
    "demonstrating.js",
    "watching.js",
    "page.js",
)
STYLES = ("house.css", "drawing.css")
CHECKPOINT = "ttp_plus"  # that loads the next dishwasher
# The kitchens are fresh ones: those of the session seed 0 are the published test.
SALT = 1
KITCHENS = 12  # to show in, and as many to load
INCOMPLETE = range(7)  # of the first user's sessions each lacks another category
CONSENT = (
    "We record which dish you put where and in which order, with your code and the number of the "
    "day: no name, no time, no address and no picture. The recordings are kept for the study "
    "STUDY, used for research on robots that learn preferences, and published. Taking part is "
    "voluntary; you may stop at any time without a reason. By starting you say that you are 18 or "
    "older, have read this, and agree."
)  # docs/study.md has the whole text


def demonstration_page(study: str | None = None, save_to: str | None = None) -> str:
    """The page's HTML, which needs no network and no server.

    Args:
        study: The study that the page is for; an address that ends with `?study=NAME` does the
            same.
        save_to: Where each finished demonstration is posted; None where nothing serves the page.

    Raises:
        ValueError: If the committed checkpoint is damaged.
    """
    scripts = (
        joined(*(SHARED / name for name in SHARED_SCRIPTS)),
        policy_script(),
        joined(*(THREE / name for name in THREE_SCRIPTS)),
        joined(*(TEMPLATES / name for name in SCRIPTS)),
    )
    return self_contained_page(
        template=joined(TEMPLATES / "page.html"),
        style=joined(
            *(SHARED / name for name in STYLES), THREE / "kitchen3d.css", TEMPLATES / "page.css"
        ),
        script="\n".join(scripts),
        data=page_data(study, save_to),
        connects=save_to is not None,
    )


def page_data(study: str | None, save_to: str | None) -> dict[str, Any]:
    """All that the page holds beside its scripts."""
    sessions = page_sessions(2 * KITCHENS, SALT)
    incomplete = [make_session("incomplete_prompts", index, SALT) for index in INCOMPLETE]
    kitchens = {
        "show": sessions[:KITCHENS],
        "load": sessions[KITCHENS:],
        "incomplete": incomplete,
        "study": [study_session()],
    }
    return {
        "version": DATA_VERSION,
        "most": {"decisions": MAX_EPISODE_STEPS, "rows": PROMPT_CAPACITY},
        "layout": layout_data(),
        "observed": observed_kitchen(),
        "kitchens": {use: [_kitchen_data(one) for one in of] for use, of in kitchens.items()},
        "policy": policy_data(find_checkpoint(CHECKPOINT)),
        "aboutPolicy": f"TTP's checkpoint {CHECKPOINT}, trained on the ways of others alone.",
        "glb": _kitchen_in_three_dimensions(),
        "study": study,
        "saveTo": save_to,
        "consent": CONSENT,
    }


def _kitchen_in_three_dimensions() -> str | None:
    """The kitchen's .glb file in base64; None without MuJoCo, where the drawing is all there is."""
    if find_spec("mujoco") is None:
        return None
    from kitchen_prefs_demonstrations.page.kitchen_gltf import kitchen_glb

    return base64.b64encode(kitchen_glb()).decode()


def _kitchen_data(session: Session) -> dict[str, Any]:
    """A kitchen to act in: without its own user's preference and what the expert does."""
    seen = observed_session(session)
    left_out = ("expert", "preference")
    return {
        "split": session.split,
        "index": session.index,
        "salt": session.salt,
        **{name: value for name, value in seen.items() if name not in left_out},
    }
