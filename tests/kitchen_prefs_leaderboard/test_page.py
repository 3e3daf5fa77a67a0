"""The leaderboard's page in a browser: Debian's chromium, without a network."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from chromium import PATIENCE, needs_chromium, opened, running_chromium
from typer.testing import CliRunner

from kitchen_prefs import instances
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.metrics import ALL_METRICS, FURTHER_METRICS
from kitchen_prefs.simulation import kitchen as k
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import TEST_SPLITS, get_split
from kitchen_prefs_leaderboard import commands, scoring
from kitchen_prefs_leaderboard.page.building import write_page
from kitchen_prefs_leaderboard.ranking import rank
from kitchen_prefs_leaderboard.scoring import Entry, score_submissions
from kitchen_prefs_leaderboard.submission_format import Plugin, Policy
from kitchen_prefs_leaderboard.verification import ScoreInterval, Verification

HTML_NAME = "<img src=x onerror=document.title='run'></script><b>"
SCORES = Path(__file__).parents[2] / "leaderboard" / "scores.json"
PLUGIN = Plugin(distribution="lerobot_policy_elsewhere", version="1.2", code="c" * 64)
PHONE = {"width": 390, "height": 844}

pytestmark = [
    pytest.mark.xdist_group("page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


def careless_episode(split, index):
    """An episode that begins with a refused decision and puts all dishes into the top rack."""
    simulator = EpisodeSimulator(make_session(split, index))

    def decide(instance):
        row = simulator.observation.row_of(instance)
        return simulator.decide(instance, simulator.observation.rows[row, instances.POSE])

    for instance in (k.TOP_RACK, k.DOOR, k.TOP_RACK):
        decide(instance)
    while len(counter := simulator.kitchen.counter) and not simulator.truncated:
        decide(k.FIRST_DISH + int(counter[0]))
        if simulator.kitchen.held is not None and not simulator.truncated:
            category = int(simulator.kitchen.dishes.category[simulator.kitchen.held])
            free = simulator.kitchen.free("top", category)
            decide(k.FIRST_PLACEMENT["top"] + int(free[0]) if len(free) else k.SINK)
    for instance in (k.TOP_RACK, k.DOOR):
        if not simulator.truncated:
            decide(instance)
    return simulator.episode()


@pytest.fixture(scope="module")
def entries(expert_submission):
    """The expert, with a re-run, and three more on two tracks, without."""
    (expert,) = score_submissions([expert_submission], 1)
    careless = {
        split: [careless_episode(split, i) for i in range(get_split(split).sessions)]
        for split in TEST_SPLITS
    }

    def other(name, track, episodes):
        about = {"name": name, "track": track, "link": "https://example.org/?a=1&b=2"}
        if track == "open":
            about["policy"] = Policy(type="elsewhere", plugin=PLUGIN)
        return Entry(expert.submission.model_copy(update=about), name, episodes)

    return [
        expert,
        other("Careless", "privileged", careless),
        other("Honest", "privileged", expert.episodes),
        other(HTML_NAME, "open", careless),
    ]


@pytest.fixture(scope="module")
def verified(entries):
    """A re-run that confirms the expert."""
    means = ScoreInterval(mean=1, low=1, high=1)
    return {
        entries[0].digest: Verification(
            digest=entries[0].digest,
            packages={"torch": "2"},
            salt=1,
            same=1,
            replayed=means,
            rerun=means,
            fresh=means,
            repeats=True,
            generalises=True,
        )
    }


@pytest.fixture(scope="module")
def tables(entries, verified):
    """The rows of each track."""
    return rank(entries, verified)


@pytest.fixture(scope="module")
def file(tables, tmp_path_factory):
    """The page."""
    out = tmp_path_factory.mktemp("page") / "leaderboard.html"
    write_page({"preferences": tables}, out)
    return out


@pytest.fixture(scope="module")
def browser():
    """A browser without a window."""
    with running_chromium() as browser:
        yield browser


@pytest.fixture
def page(browser, file):
    """The page, opened; at the end the console is empty and nothing was fetched."""
    with opened(browser, file, viewport={"width": 1280, "height": 900}) as page:
        yield page


def names(page, track="privileged", block="replayed only"):
    """The names in a block of a track's table that are not hidden."""
    rows = page.locator(f'[data-track="{track}"] tbody[data-block="{block}"] tr:visible .more')
    return rows.all_text_contents()


def committed_scores():
    """The scores of this repository's entries."""
    return json.loads(SCORES.read_text())


def open_careless(page):
    """Open the first session of the imperfect entry."""
    page.locator("#viewer-entry").select_option(label="Careless (privileged)")


def test_ranked_rows_come_first_and_the_others_have_no_rank(page):
    assert names(page, block="re-run") == ["The expert"]
    assert names(page) == ["Honest", "Careless"]
    ranks = page.locator('[data-track="privileged"] td.rank').all_text_contents()
    assert ranks == ["1", "\u2013", "\u2013"]


def test_a_row_tells_which_code_a_policy_from_elsewhere_has(page):
    plugin = page.locator("tr dt", has_text="Plug-in")
    assert not plugin.is_visible()
    more = page.locator(".more", has_text=HTML_NAME)
    more.click()
    assert more.get_attribute("aria-expanded") == "true"
    assert plugin.is_visible()
    told = plugin.locator("+ dd").all_text_contents()
    assert told == [f"lerobot_policy_elsewhere 1.2, code {'c' * 64}"]
    page.locator('[data-track="open"] th button', has_text="Score").click()  # sorts
    row = page.locator("tr", has=more)
    assert row.locator("+ tr").locator("dt", has_text="Plug-in").count() == 1


def test_a_tie_shows(tables, tmp_path, browser):
    tied = {
        track: [replace(row, rank=2, tied=True) for row in rows] for track, rows in tables.items()
    }
    out = tmp_path / "tied.html"
    write_page({"preferences": tied}, out)
    page = browser.new_page()
    page.goto(out.as_uri(), timeout=PATIENCE)
    assert set(page.locator("td.rank").all_text_contents()) == {"2 ="}
    page.close()


def test_a_header_sorts_within_the_blocks(page):
    table = page.locator('[data-track="privileged"]')
    header = table.get_by_role("columnheader", name="PE")
    header.get_by_role("button").click()
    assert header.get_attribute("aria-sort") == "descending"
    assert names(page) == ["Honest", "Careless"]
    header.get_by_role("button").press("Enter")
    assert header.get_attribute("aria-sort") == "ascending"
    assert names(page) == ["Careless", "Honest"]
    assert names(page, block="re-run") == ["The expert"]
    assert table.locator("[aria-sort]").count() == 1


def test_text_and_track_filter(page):
    page.get_by_label("Search").fill("CARELESS")
    assert names(page) == ["Careless"]
    assert page.get_by_role("status").text_content() == "1 of 4 entries"
    page.get_by_label("Search").fill("")
    page.locator("#track").select_option("open")
    assert not page.locator('[data-track="privileged"]').is_visible()
    assert names(page, track="open") == [HTML_NAME]


def test_columns_show_every_metric_of_every_split(page, tables):
    rows = [row.entry for of_track in tables.values() for row in of_track]
    for split in (scoring.MEAN, *TEST_SPLITS):
        page.get_by_label("Columns").select_option(f"split:{split}")
        shown = page.locator("#tables td.number b").all_text_contents()
        assert len(shown) == 10 * len(rows) == len(ALL_METRICS) * len(rows)
        wanted = [i.mean for entry in rows for i in entry.metrics[split].values()]
        assert [float(text.replace("\u2212", "-")) for text in shown] == pytest.approx(
            wanted, abs=6e-4
        )
    page.get_by_label("Columns").select_option("metric:PE")
    heads = page.locator('[data-track="open"] thead th').all_text_contents()
    assert heads == ["Show", "Rank", "Name", "mean", *(s.replace("_", " ") for s in TEST_SPLITS)]


def test_the_further_metrics_are_those_of_the_committed_scores(page):
    (expert,) = (entry for entry in committed_scores() if entry["name"] == "expert")
    heads = page.locator('[data-track="privileged"] thead th').all_text_contents()
    row = page.locator('[data-track="privileged"] tbody[data-block="re-run"] td.number b')
    shown = dict(zip(heads[3:], row.all_text_contents(), strict=True))
    assert "Rescaledfloor\u00a00, ceiling\u00a01" in shown
    for head, text in list(shown.items())[-len(FURTHER_METRICS) :]:
        metric = head.removesuffix("floor\u00a00, ceiling\u00a01")
        assert metric in FURTHER_METRICS
        assert float(text) == pytest.approx(expert["splits"]["mean"][metric]["mean"], abs=6e-4)


def test_floor_and_ceiling_are_those_of_the_committed_scores(page):
    by_name = {entry["name"]: entry["splits"] for entry in committed_scores()}
    rows = page.locator("#references tbody tr").all_text_contents()
    ends = {
        name: [f"{by_name[name][split]['Score']['mean']:.3f}" for split in TEST_SPLITS]
        for name in ("promptless", "bayes")
    }
    assert rows == [
        "floor: promptless" + "".join(ends["promptless"]),
        "ceiling: bayes" + "".join(ends["bayes"]),
    ]
    page.get_by_label("Columns").select_option("metric:Rescaled")
    head = page.locator('[data-track="open"] thead th', has_text="noisy").text_content()
    assert head == f"noisyfloor\u00a0{ends['promptless'][-1]}, ceiling\u00a0{ends['bayes'][-1]}"


def test_ticked_rows_are_in_the_charts(page):
    assert page.locator("#chart-legend li").count() == 4
    assert page.locator("#by-split svg").count() == len(TEST_SPLITS)
    page.get_by_label("Show Careless in the charts").uncheck()
    assert page.locator("#chart-legend li").count() == 3
    assert "Careless" not in page.locator("#by-count svg").first.get_attribute("aria-label")


def test_names_are_text(page):
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2
    assert page.title() == "kitchen_prefs leaderboard"
    assert names(page, track="open") == [HTML_NAME]
    link = page.locator('[data-track="open"] a')
    assert link.get_attribute("rel") == "noopener noreferrer nofollow"


def test_data_cannot_close_its_element(file):
    html = file.read_text()
    data = html.split('<script type="application/json" id="data">')[1].split("</script>")[0]
    assert not set("<>&") & set(data)
    assert HTML_NAME in {e["submission"]["name"] for e in json.loads(data)["entries"]}


def test_an_episode_steps_to_its_end(page, entries):
    open_careless(page)
    episode = entries[1].episodes["seen"][0]
    page.get_by_role("button", name="Next").click()
    assert (
        page.locator("#policy-decision")
        .text_content()
        .startswith("refused: pulls the top rack out")
    )
    page.get_by_role("button", name="Last").click()
    decided = len(episode.decisions)
    assert page.locator("#policy-step").text_content() == f"{decided} of {decided}"
    racked = page.locator(
        '#policy-drawing [data-place="top"], #policy-drawing [data-place="bottom"]'
    )
    assert racked.count() == sum(episode.placed) + episode.wrong_rack
    assert page.locator('#policy-drawing [data-place="sink"]').count() == episode.sunk
    expert = page.locator(
        '#expert-drawing [data-place="top"], #expert-drawing [data-place="bottom"]'
    )
    assert expert.count() == sum(episode.expert_placed)


def test_every_episode_ends_as_in_the_kitchen(page, tables):
    ends = page.evaluate(
        """() => data.entries.map((entry) => SPLITS.map((split) =>
            entry.drawn.episodes[split].map(([decisions, refused], number) => {
                const steps = replay(data.sessions[split][number], decisions, refused);
                const { places, doorOpen, out } = steps.at(-1).state;
                const count = (place) => places.filter((one) => one === place).length;
                return [count("top") + count("bottom"), count("sink"), !doorOpen && out === null];
            })))"""
    )
    rows = [row.entry for of_track in tables.values() for row in of_track]
    assert ends == [
        [
            [[sum(e.placed) + e.wrong_rack, e.sunk, e.closed] for e in entry.episodes[split]]
            for split in TEST_SPLITS
        ]
        for entry in rows
    ]


def test_the_keyboard_steps(page):
    open_careless(page)
    page.locator("#viewer").focus()
    slider = page.locator("#slider")
    for key, step in (("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("Home", 0)):
        page.keyboard.press(key)
        assert slider.input_value() == str(step)
    page.keyboard.press("End")
    assert slider.input_value() == slider.get_attribute("max")
    slider.focus()
    page.keyboard.press("ArrowLeft")
    assert int(slider.input_value()) == int(slider.get_attribute("max")) - 1
    page.get_by_role("button", name="Play").press("Enter")
    page.get_by_role("button", name="Pause").wait_for(state="hidden")  # one step, then the end
    assert slider.input_value() == slider.get_attribute("max")


def test_a_failure_mode_opens_its_episodes(page, entries):
    page.locator("#failure-modes-entry").select_option(label="Careless (privileged)")
    wrong = entries[1].failure_modes["seen"]["wrong rack"]
    page.get_by_role("button", name=f"{wrong} episodes of seen: wrong rack").click()
    assert page.locator("#viewer-session option").count() == wrong
    assert "wrong rack" in page.locator("#episode-facts").text_content()


def test_a_phone_scrolls_tables_and_not_the_page(page):
    page.set_viewport_size(PHONE)
    for more in page.locator(".more").all():
        more.click()
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    boxes = page.locator(".scroll").evaluate_all(
        "all => all.map(box => box.scrollWidth > box.clientWidth)"
    )
    assert any(boxes)


def test_the_theme_toggles(page):
    def ground():
        return page.evaluate("getComputedStyle(document.body).backgroundColor")

    light = ground()
    page.get_by_role("button", name="Dark").click()
    assert ground() != light
    page.get_by_role("button", name="Light").click()
    assert ground() == light


def test_the_command_writes_the_page(entries, file, verified, tmp_path, monkeypatch):
    monkeypatch.setattr(scoring, "score_submissions", lambda folders, jobs: entries)
    for digest, verification in verified.items():
        (tmp_path / f"{digest}.json").write_text(verification.model_dump_json())
    out = tmp_path / "new" / "page.html"
    options = ["page", "any", f"--out={out}", f"--verifications={tmp_path}"]
    result = CliRunner().invoke(commands.app, options)
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == file.read_bytes()
