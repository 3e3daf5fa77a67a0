"""A submission from somebody who means harm: one sentence, little memory, a safe terminal."""

import bz2
import json
import os
import signal
import subprocess
import sys
import time
import unicodedata
import warnings

import pytest
from fuzzing.honest import ABOUT, EPISODE, POSE
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from rich.console import Console

from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import TEST_SPLITS, get_split
from kitchen_prefs.utils.untrusted_files import read_bytes
from kitchen_prefs_leaderboard import scoring
from kitchen_prefs_leaderboard.page.building import to_html
from kitchen_prefs_leaderboard.replay import replay
from kitchen_prefs_leaderboard.score_formats import to_tables
from kitchen_prefs_leaderboard.scoring import Entry, read_known, score_submissions
from kitchen_prefs_leaderboard.submission_format import ACTIONS, DESCRIPTION, Line, Submission
from kitchen_prefs_leaderboard.submission_reading import (
    MOST_COMPRESSED,
    MOST_DESCRIPTION,
    MOST_LINE,
    MOST_LINES,
    parse_description,
    parse_lines,
)
from kitchen_prefs_leaderboard.verification import read_verifications

pytestmark = pytest.mark.xdist_group("hostile_submissions")  # one fixture of the module serves all

SEEN = ACTIONS["seen"]
# Well-formed: the reader has nothing to say against it, only the kitchen has.
EPISODES = {
    split: b"".join(
        json.dumps(EPISODE | {"session": session}).encode() + b"\n"
        for session in range(get_split(split).sessions)
    )
    for split in TEST_SPLITS
}
LONGEST = 600  # characters of a sentence
MOST_MEMORY = 120  # MB
# The machine may be busy, and the first text takes hypothesis seconds.
WHICH = ("means", "further means")
PATIENT = settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
TRICKS = [
    b"\x00", b"\x1b[31m", b"\\u001b]0;", b"\r", b"\n", b"\xff\xfe", b"\xef\xbb\xbf", b"\\ud800",
    "\u2028".encode(), "\u202e".encode(), b"NaN", b"-Infinity", b"1e999", b"-0.0", b"5e-324",
    b"9" * 5000, b"[" * 300, b'{"a":' * 300, b'"name":"again",', bz2.compress(b"more"),
]  # fmt: skip


def write(folder):
    """Write a well-formed submission, named as its folder is."""
    folder.mkdir()
    (folder / DESCRIPTION).write_text(json.dumps(ABOUT | {"name": folder.name}))
    for split, text in EPISODES.items():
        (folder / ACTIONS[split]).write_bytes(bz2.compress(text))
    return folder


@pytest.fixture
def folder(tmp_path):
    return write(tmp_path / "untrusted")


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A folder whose files are written anew for every example."""
    return write(tmp_path_factory.mktemp("shared") / "untrusted")


def read_description(folder):
    file = folder / DESCRIPTION
    return parse_description(read_bytes(file, MOST_DESCRIPTION), file)


def read_lines(folder, split):
    file = folder / ACTIONS[split]
    return parse_lines(read_bytes(file, MOST_COMPRESSED), split, file)


def check_sentence(sentence, file):
    assert sentence.startswith(str(file))
    assert sentence.isprintable()
    assert len(sentence) < LONGEST


def refused(read, *arguments, file, message=""):
    with pytest.raises(ValueError, match=message) as error:
        read(*arguments)
    check_sentence(str(error.value), file)


def check_description(folder, content):
    """What is read is exactly what stands there and can be shown, or one sentence says why not."""
    file = folder / DESCRIPTION
    file.write_bytes(content)
    try:
        found = read_description(folder)
    except ValueError as error:
        check_sentence(str(error), file)
        return
    assert found.model_dump(mode="json", exclude_unset=True) == json.loads(content)
    assert Submission.model_validate(found.model_dump()) == found
    for text in (found.name, *found.authors, found.hardware, found.training, *found.packages):
        assert not {unicodedata.category(c) for c in text} & {"Cc", "Cf", "Cs", "Zl", "Zp"}


def check_lines(folder, content):
    """The same for the lines of a split, given as they stand in the file."""
    file = folder / SEEN
    file.write_bytes(content)
    try:
        found = read_lines(folder, "seen")
    except ValueError as error:
        check_sentence(str(error), file)
        return
    said = [json.loads(line) for line in bz2.decompress(content).splitlines()]
    assert [line.model_dump(mode="json") for line in found] == said


@st.composite
def damaged(draw, content):
    """Bytes of which a few places are cut out, exchanged or filled with tricks."""
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(content)))
        end = draw(st.sampled_from([start, start + 1, start + 20, len(content)]))
        put = draw(st.just(b"") | st.binary(max_size=8) | st.sampled_from(TRICKS))
        content = content[:start] + put + content[end:]
    return content


ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**400), 10**400)
    | st.floats()
    | st.text(st.characters(), max_size=70)
    | st.lists(st.sampled_from([POSE, POSE[1:], 0.0]), max_size=200),
    lambda inner: (
        st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=70), inner, max_size=5)
    ),
    max_leaves=10,
)


@st.composite
def changed(draw, content):
    """A JSON object in which one value, anywhere, is exchanged for another or added."""
    whole = inner = json.loads(json.dumps(content))
    key = draw(st.sampled_from(sorted(inner)) | st.text(max_size=70))
    while isinstance(inner.get(key), dict) and draw(st.booleans()):
        inner = inner[key]
        key = draw(st.sampled_from([*sorted(inner), "new"]) | st.text(max_size=70))
    inner[key] = draw(ANYTHING)
    return json.dumps(whole, ensure_ascii=draw(st.booleans())).encode(errors="surrogatepass")


@settings(PATIENT, max_examples=400)
@given(damaged(json.dumps(ABOUT).encode()) | changed(ABOUT))
def test_whatever_the_description_is(shared, content):
    check_description(shared, content)


@PATIENT
@given(st.data())
def test_whatever_the_lines_are(shared, data):
    first, rest = EPISODES["seen"].split(b"\n", maxsplit=1)
    first = data.draw(damaged(first) | changed(EPISODE))
    check_lines(shared, bz2.compress(first + b"\n" + rest))


@PATIENT
@given(damaged(bz2.compress(EPISODES["seen"])))
def test_whatever_the_compressed_file_is(shared, content):
    check_lines(shared, content)


@PATIENT
@given(st.lists(st.tuples(*[st.floats(-1000, 1000)] * 7), min_size=1, max_size=5))
@example([(0.0,) * 7, (-0.0,) * 7, (5e-324,) * 7, (1e-200,) * 7, (1000.0,) * 7])
def test_whatever_the_poses_are(actions):
    first = EpisodeSimulator(make_session("seen", 0)).digest()
    line = Line(session=0, first=first, actions=actions, last="0" * 64)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning would be a second line
        refused(replay, "seen", line, "F", file="F", message="continues after the last action")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-32", "utf-8-sig", "latin-1", "cp037"])
def test_other_encodings(folder, encoding):
    text = json.dumps(ABOUT | {"name": "Zoë"}, ensure_ascii=False)
    (folder / DESCRIPTION).write_bytes(text.encode(encoding))
    refused(
        read_description, folder, file=folder / DESCRIPTION, message="does not follow the format"
    )


def test_a_description_that_is_cut_off_anywhere(folder):
    whole = json.dumps(ABOUT)
    for length in range(len(whole)):
        (folder / DESCRIPTION).write_text(whole[:length])
        refused(read_description, folder, file=folder / DESCRIPTION, message="Invalid JSON: EOF")


@pytest.mark.parametrize(
    "number", ["NaN", "Infinity", "1e999", "1e4000", "9" * 5000, '"1"', "null", "true"]
)
def test_numbers_that_are_none(folder, number):
    line = json.dumps(EPISODE).replace("0.5", number, 1)
    (folder / SEEN).write_bytes(bz2.compress(line.encode()))
    message = "line 1 does not follow the format"
    refused(read_lines, folder, "seen", file=folder / SEEN, message=message)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("name", ""),
        ("name", " "),
        ("name", "Honest "),
        ("name", "a\nb"),
        ("name", "a\u2028b"),
        ("name", "\x1b[31mred"),
        ("name", "\u202egnp.exe"),
        ("name", "x" * 61),
        ("name", "=1+1"),
        ("track", "secret"),
        ("link", "javascript:alert(1)"),
        ("data_version", True),
        ("score", 1.0),
        ("authors", []),
        ("\x1b[2J\u202e", 1),
        ("x" * 1000, 1),
    ],
)
def test_descriptions_that_are_none(folder, field, value):
    (folder / DESCRIPTION).write_text(json.dumps(ABOUT | {field: value}))
    shown = field[:40].replace("\x1b[2J\u202e", r"\?\[2J\?")
    message = f"submission.json does not follow the format: {shown}: "
    refused(read_known, folder, file=folder / DESCRIPTION, message=message)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\x00" * 1000, "is not a bzip2 file"),
        (os.urandom(MOST_COMPRESSED + 1), "is larger than 1,048,576 bytes"),
        (bz2.compress(b"[" * (MOST_LINES + 1)), "holds more than 4,194,304 bytes"),
        (bz2.compress(bz2.compress(EPISODES["seen"])), "line 1 does not follow the format"),
        (bz2.compress(EPISODES["seen"]) * 2, "is not one whole bzip2 file"),
        (bz2.compress(EPISODES["seen"]) + b"more", "is not one whole bzip2 file"),
        (bz2.compress(EPISODES["seen"])[:-1], "is not one whole bzip2 file"),
        (bz2.compress(b"[" * (MOST_LINE + 1)), "line 1 is longer than 65,536 bytes"),
        (bz2.compress(b"[" * 50_000), "line 1 does not .*: recursion limit exceeded"),
        (bz2.compress(b"\n" * MOST_LINES), "line 1 does not follow the format"),
        (
            bz2.compress(EPISODES["seen"].replace(b"}\n", b"}\r", 1) + b"\r"),
            "line 71 does not",
        ),
        (b"", "is not one whole bzip2 file"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_files_that_hold_no_lines(folder, content, message):
    (folder / SEEN).write_bytes(content)
    refused(read_lines, folder, "seen", file=folder / SEEN, message=message)


@pytest.mark.parametrize(
    ("exchange", "message"),
    [
        (lambda file: None, "cannot be read: No such file"),
        (lambda file: file.symlink_to("/dev/zero"), "is a link; give the file itself"),
        (lambda file: file.symlink_to("nowhere"), "is a link; give the file itself"),
        (lambda file: file.mkdir(), "cannot be read: Is a directory"),
        (os.mkfifo, "is not a regular file"),
    ],
    ids=["missing", "link", "dangling link", "folder", "pipe that nobody writes"],
)
@pytest.mark.parametrize("name", [DESCRIPTION, SEEN])
def test_what_is_no_file(folder, name, exchange, message):
    (folder / name).unlink()
    exchange(folder / name)
    refused(score_submissions, [folder], 1, file=folder / name, message=message)


def test_a_link_to_a_folder_is_the_operators(folder, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(folder)
    assert read_description(link) == read_description(folder)


def test_a_folders_name_does_not_reach_the_terminal_as_it_is(kitchen_prefs, tmp_path):
    said = kitchen_prefs("leaderboard", "score", tmp_path / "a\x1b]0;owned\x07")
    assert said.isprintable()
    assert "a?]0;owned?" in said


@pytest.mark.parametrize("name", ["a/../../outside", "C:\\x", "a${HOME}"])
def test_a_name_is_never_a_path(folder, tmp_path, name):
    about = ABOUT | {"name": name, "policy": {"type": name}, "fingerprints": {name: "0" * 64}}
    (folder / DESCRIPTION).write_text(json.dumps(about))
    before = sorted(tmp_path.rglob("*"))
    refused(score_submissions, [folder], 1, file=folder, message="with another data set")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "content",
    [b"", b"\xff", b"[" * 10_000, b'{"digest": "../../outside"}', b'{"\x1b[31m": NaN}'],
)
def test_a_record_that_is_none(tmp_path, content):
    file = tmp_path / "record.json"
    file.write_bytes(content)
    refused(read_verifications, tmp_path, file=file, message="is no record of a re-run")


@pytest.fixture(scope="module")
def greedy(tmp_path_factory):
    """Submissions that want memory: each has one file that looks small or is none."""
    bomb = bz2.compress(bytes(200 * 10**6))  # 178 bytes; a gigabyte would be as small
    small = [[0] * 7] * 160
    full = json.dumps(EPISODE | {"actions": small}, separators=(",", ":")).encode() + b"\n"
    lines = {
        "bomb": bomb,
        "bomb in a bomb": bz2.compress(bomb),
        "one line": bz2.compress(b"[" * MOST_LINES),
        "no lines": bz2.compress(b"\n" * MOST_LINES),
        "many fields": bz2.compress(b"{" + b'"a":0,' * 600_000 + b'"a":0}'),
        "many mistakes": bz2.compress(b"{" + b'"a":0,' * 10_000 + b'"a":0}'),
        "many actions": bz2.compress(b'{"actions":[' + b"[0,0,0,0,0,0,0]," * 200_000 + b"0]}"),
        "many lines": bz2.compress(full * (MOST_LINES // len(full))),
    }
    folders = {name: write(tmp_path_factory.mktemp("greedy") / "untrusted") for name in lines}
    for name, folder in folders.items():
        (folder / SEEN).write_bytes(lines[name])
    folders["a gigabyte"] = write(tmp_path_factory.mktemp("greedy") / "untrusted")
    with open(folders["a gigabyte"] / DESCRIPTION, "wb") as file:
        file.truncate(10**9)
    return folders


# The peak of this program alone; what getrusage says counts whoever started it, too.
READ_ALL = """
import sys
from pathlib import Path
from kitchen_prefs_leaderboard.submission_reading import read_submission

for folder in map(Path, sys.argv[1:]):
    try:
        read_submission(folder).lines("seen")
    except ValueError as error:
        print(error, file=sys.stderr)
    status = dict(line.split(":", 1) for line in open("/proc/self/status"))
    print(int(status["VmHWM"].split()[0]) // 1024)
"""


def test_memory_stays_bounded(folder, greedy):
    """Nothing needs more than lines do: 4 MiB hold 240,000 actions, of some 300 bytes once read."""
    folders = [folder, *greedy.values()]
    reader = subprocess.run(
        [sys.executable, "-c", READ_ALL, *folders], capture_output=True, text=True, check=True
    )
    honest, *others = map(int, reader.stdout.split())
    assert len(reader.stderr.splitlines()) == len(others) == len(greedy)
    grown = {name: peak - honest for name, peak in zip(greedy, others, strict=True)}
    assert max(grown.values()) < MOST_MEMORY, grown


def score_from_the_shell(*folders):
    command = [sys.executable, "-m", "kitchen_prefs.cli", "leaderboard", "score", *folders]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        (DESCRIPTION, json.dumps(ABOUT | {"\x1b]0;owned\x07": 1}).encode()),
        (DESCRIPTION, json.dumps(ABOUT, indent=1)[:-40].encode("utf-16")),
        (SEEN, bz2.compress(b"[" * MOST_LINES * 2)),
        (SEEN, bz2.compress(EPISODES["seen"])),
    ],
    ids=["escapes", "another encoding", "bomb", "a lie"],
)
def test_the_command_says_one_sentence(folder, name, content):
    (folder / name).write_bytes(content)
    result = score_from_the_shell(folder)
    assert result.returncode == 1
    assert result.stdout == ""
    check_sentence(result.stderr.removesuffix("\n"), f"kitchen-prefs: {folder / name}")


@pytest.fixture
def untouched_entry():
    """A submission with an episode of each split in which nothing was done."""
    episodes = {
        split: [EpisodeSimulator(make_session(split, 0)).episode()] for split in TEST_SPLITS
    }
    return Entry(Submission.model_validate(ABOUT), "0" * 64, episodes)


@pytest.mark.parametrize("name", ["[red]x[/red]", "[/b]", "[link=file:///]x[/link]", ":fire:"])
def test_a_terminal_shows_a_name_as_it_is(untouched_entry, name):
    about = untouched_entry.submission.model_copy(update={"name": name})
    console = Console(force_terminal=True, width=200, color_system="truecolor")
    with console.capture() as shown:
        console.print(*to_tables(Entry(about, "", untouched_entry.episodes), by="count"), sep="\n")
    titles = [line.strip() for line in shown.get().splitlines() if name in line]
    means, further = (f"{name}: {which} with 95 % intervals" for which in WHICH)
    assert titles == [means, f"{means}, by count", further, f"{further}, by count"]


@PATIENT
@given(st.text())
def test_no_text_leaves_the_pages_data(text):
    html = to_html({"name": text, text: [text]})
    data = html.split('<script type="application/json" id="data">')[1].split("</script>")[0]
    assert not set("<>&\u2028\u2029") & set(data)
    assert json.loads(data) == {"name": text} | {text: [text]}


def first_lies(submission, split):
    """Stands in for a replay: the first split is refused, the others take time."""
    (submission.folder / f"{split}.replayed").touch()
    if split == TEST_SPLITS[0]:
        raise ValueError(f"{submission.folder} lies.")
    time.sleep(0.2)


def is_killed(submission, split):
    """Stands in for a replay whose process the system ends."""
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_malformed_submission_is_refused_before_anything_is_replayed(
    folder, tmp_path, monkeypatch
):
    last = write(tmp_path / "last")
    (last / "noisy.jsonl.bz2").write_bytes(b"")
    monkeypatch.setattr(scoring, "replay_split", first_lies)
    refused(score_submissions, [folder, last], 1, file=last / "noisy.jsonl.bz2", message="bzip2")


def test_a_lie_ends_the_work(folder, tmp_path, monkeypatch):
    others = [write(tmp_path / f"other-{number}") for number in range(3)]
    monkeypatch.setattr(scoring, "replay_split", first_lies)
    refused(score_submissions, [folder, *others], 2, file=folder, message="lies")
    replayed = len(list(tmp_path.rglob("*.replayed")))
    assert replayed < len(others) * len(TEST_SPLITS), "what was not begun must not begin"


def test_a_process_that_is_killed(folder, monkeypatch):
    monkeypatch.setattr(scoring, "replay_split", is_killed)
    with pytest.raises(OSError, match="was killed; give fewer --jobs if memory is short"):
        score_submissions([folder], 2)
