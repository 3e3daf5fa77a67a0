"""Names and links of strangers: what a reader sees is what is there."""

import ipaddress
import re
import unicodedata
from urllib.parse import urlsplit

from confusable_homoglyphs.confusables import confusables_data

# Letters and marks that are not drawn (Unicode's Default_Ignorable_Code_Point among them) and the
# braille pattern of no dots.
INVISIBLE = re.compile(
    "[\u00ad\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0"
    "\U000e0100-\U000e01ef]"
)
MOST_MARKS = 2  # accents on one letter; more are stacked over the lines above
DYNAMIC_DATA = "|"  # a spreadsheet's cell could start a program through it
# Small letters of which some form looks like another: I, l and 1; O and 0.
ONE_LETTER = str.maketrans("i10", "llo")
# Scripts that are written together.
TOGETHER = ({"CJK", "HIRAGANA", "KATAKANA"}, {"CJK", "HANGUL"}, {"CJK", "BOPOMOFO"})


def check_visible(text: str) -> str:
    """A text that shows what it is.

    Raises:
        ValueError: If it is not in normal form (NFKC), has invisible or stacked characters, letters
            of several scripts, or right-to-left letters beside numbers, which change places.
    """
    if unicodedata.normalize("NFKC", text) != text:
        raise ValueError("its characters are not in normal form (NFKC)")
    if INVISIBLE.search(text):
        raise ValueError("it has an invisible character")
    if DYNAMIC_DATA in text:
        raise ValueError(f"it has the character {DYNAMIC_DATA}")
    marks = "".join("m" if unicodedata.combining(c) else "." for c in text)
    if "m" * (MOST_MARKS + 1) in marks:
        raise ValueError("it has stacked accents")
    scripts = {unicodedata.name(c, "?").split()[0] for c in text if c.isalpha()}
    if len(scripts) > 1 and not any(scripts <= together for together in TOGETHER):
        raise ValueError(f"its letters are of several scripts ({', '.join(sorted(scripts))})")
    directions = {unicodedata.bidirectional(c) for c in text}
    if directions & {"R", "AL"} and directions & {"EN", "AN", "L"}:
        raise ValueError("it mixes right-to-left letters with numbers")
    return text


def alike_key(name: str) -> str:
    """What two names have in common that a reader takes for one.

    Letters and digits alone count, without case and accents; each that looks like a Latin letter is
    that letter, whatever its script (Unicode's confusable characters).
    """
    plain = unicodedata.normalize("NFKD", name)
    latin = "".join(_latin(character) for character in plain if character.isalnum())
    return latin.translate(ONE_LETTER).replace("rn", "m")


def _latin(character: str) -> str:
    """The small Latin letter or digit that a character, or its capital, looks like, or itself."""
    for form in (character, character.upper()):
        for looks in (form, *(other["c"] for other in confusables_data.get(form, ()))):
            if looks.isascii() and looks.isalnum():
                return looks.lower()
    return character.casefold()


def check_public_link(link: str) -> str:
    """A link to a public host, which is what its reader would take it for.

    Raises:
        ValueError: If it names a user, a port, an address or a host that is not public.
    """
    parts = urlsplit(link)
    host = parts.hostname or ""
    if "@" in parts.netloc or ":" in parts.netloc:
        raise ValueError("a link names a host alone, without a user or a port")
    if not re.fullmatch(r"([a-z0-9-]+\.)+[a-z]{2,}", host) or _is_address(host):
        raise ValueError("a link names a public host in ASCII letters")
    if host.endswith((".local", ".localhost", ".internal", ".test", ".invalid", ".onion")):
        raise ValueError("a link names a public host")
    return link


def _is_address(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
