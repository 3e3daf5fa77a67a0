"""How sure the exact reader is of an episode of the second tier, given its session's prompts.

`meta/certificates.json` holds one list for each number of `people.certificates.Certificate`, an
entry an episode. Of a certified split all are at least `SURE`; in training they are what they are.
"""

import json
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from kitchen_prefs.people.certificates import Certificate, certificate
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.people.sessions import PeopleSession, people_table
from kitchen_prefs.people.splits import get_people_split
from kitchen_prefs.utils.files import write_json

CERTIFICATES = Path("meta") / "certificates.json"
DECIMALS = 6  # as many digits are the same on all machines


def certificate_of(session: PeopleSession) -> Certificate:
    """How sure the exact reader is of a session, given those of its prompts that are its user's."""
    split = get_people_split(session.split)
    posterior = Posterior([prompt.evidence for prompt in session.own_prompts], split.slips)
    found = certificate(posterior, session.dishes, people_table())
    return Certificate(round(found.destinations, DECIMALS), round(found.ranks, DECIMALS))


def write_certificates(certificates: Sequence[Certificate], root: Path) -> None:
    """Write the certificates of a data set's episodes, in their order."""
    numbers = {
        field.name: [getattr(one, field.name) for one in certificates]
        for field in fields(Certificate)
    }
    write_json(root / CERTIFICATES, numbers)


def read_certificates(root: Path) -> list[Certificate]:
    """Read the certificates of a data set's episodes, in their order."""
    numbers = json.loads((root / CERTIFICATES).read_text())
    of_episodes = zip(*(numbers[field.name] for field in fields(Certificate)), strict=True)
    return [Certificate(*values) for values in of_episodes]
