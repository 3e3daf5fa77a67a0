"""A page as one HTML file: it fetches nothing, sends nothing and runs its own script alone.

A page is a template, a style sheet, a script and data. Data may come from anybody: the page holds
them as JSON in which no HTML can begin, and the scripts show them as text alone.
"""

import base64
import hashlib
import json
from collections.abc import Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from string import Template
from typing import Any

SHARED = files("kitchen_prefs.web") / "templates"
# Nothing is fetched, nothing is sent, and only this file's own style and script are used.
POLICY = (
    "default-src 'none'; style-src {style}; script-src {script}; img-src data:; "
    "connect-src {connect}; base-uri 'none'; form-action 'none'"
)


def joined(*sources: Traversable) -> str:
    """The text of some files, one after the other."""
    return "\n".join(source.read_text(encoding="utf-8") for source in sources)


def self_contained_page(
    template: str, style: str, script: str, data: Mapping[str, Any], connects: bool = False
) -> str:
    """The HTML of a page that needs no network.

    Args:
        template: HTML with `$policy`, `$style`, `$script` and `$data` where these belong; the data
            in a script element of the type application/json, whose id is "data".
        style: The style sheet.
        script: The script, which reads the data from that element (basics.js).
        data: All that the page shows.
        connects: Whether the page may talk to the program that serves it.

    Raises:
        ValueError: If the data hold a number that JSON does not have.
    """
    return Template(template).substitute(
        policy=POLICY.format(
            style=_hash(style),
            script=_hash(script),
            connect="'self'" if connects else "'none'",
        ),
        style=style,
        script=script,
        data=_escaped_json(data),
    )


def _escaped_json(data: Mapping[str, Any]) -> str:
    """JSON that contains neither a tag nor a character reference."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def _hash(content: str) -> str:
    """How a content security policy names the content of a style or script element."""
    digest = hashlib.sha256(content.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
