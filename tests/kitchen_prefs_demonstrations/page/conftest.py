"""The page "Show it your way" and a browser."""

import pytest
from chromium import opened, running_chromium

from kitchen_prefs_demonstrations.page.building import demonstration_page

DESKTOP = {"width": 1280, "height": 900}


@pytest.fixture(scope="session")
def file(tmp_path_factory):
    """The page."""
    out = tmp_path_factory.mktemp("page") / "show.html"
    out.write_text(demonstration_page())
    return out


@pytest.fixture(scope="module")  # a process runs one at a time
def browser():
    """A browser without a window."""
    with running_chromium() as chromium:
        yield chromium


@pytest.fixture
def page(browser, file):
    """The page on a desk."""
    with opened(browser, file, viewport=DESKTOP) as page:
        yield page


@pytest.fixture
def loose_page(browser, file):
    """The page on a desk, which a test may load again and whose console may speak."""
    page = browser.new_page(viewport=DESKTOP)
    page.goto(file.as_uri())
    yield page
    page.close()
