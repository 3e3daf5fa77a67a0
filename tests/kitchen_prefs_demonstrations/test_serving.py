"""The page's server: it saves demonstrations, and takes nothing from anywhere else."""

import http.client
import json
import signal
import socket
import subprocess
import sys
import threading

import pytest

from kitchen_prefs_demonstrations.file_format import read_demonstration
from kitchen_prefs_demonstrations.serving import DemonstrationServer

PAGE = "<!doctype html><title>Show it your way</title>"  # stands in for the page


@pytest.fixture
def server(tmp_path):
    """A running server; `server.saved` lists what it reports."""
    saved = []
    with DemonstrationServer(PAGE, tmp_path, 0, lambda *facts: saved.append(facts)) as server:
        server.saved = saved
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def ask(server, method, path, body=None, **headers):
    """The status and the body of an answer; a header that is None is left out."""
    host = server.hosts[0]
    sent = {"Host": host, "Origin": f"http://{host}", "Content-Type": "application/json"}
    sent |= {name.replace("_", "-"): value for name, value in headers.items()}
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=20)
    connection.putrequest(method, path, skip_host=True)
    if body is not None and "Content-Length" not in sent:
        sent["Content-Length"] = str(len(body))
    for name, value in sent.items():
        if value is not None:
            connection.putheader(name, value)
    connection.endheaders(body)
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def test_it_serves_the_page(server):
    assert ask(server, "GET", "/") == (200, PAGE)
    assert ask(server, "GET", "/", Host=server.hosts[1]) == (200, PAGE)


def test_each_demonstration_is_a_file_at_once(server, tmp_path, content):
    for number in (1, 2):
        status, body = ask(server, "POST", "/demonstrations", json.dumps(content).encode())
        assert (status, json.loads(body)) == (201, {"file": f"demonstration-000{number}.json"})
    assert files(tmp_path) == ["demonstration-0001.json", "demonstration-0002.json"]
    assert read_demonstration(tmp_path / "demonstration-0001.json").model_dump() == content
    assert [replayed.finished for _, replayed in server.saved] == [True, True]


def test_name_and_consent_of_a_saved_demonstration_may_change_and_nothing_else(
    server, tmp_path, content
):
    ask(server, "POST", "/demonstrations", json.dumps(content).encode())
    file = "demonstration-0001.json"
    renamed = content | {"user": "Bo", "consent": False}
    status, _ = ask(server, "POST", f"/demonstrations/{file}", json.dumps(renamed).encode())
    assert status == 201
    assert read_demonstration(tmp_path / file).model_dump() == renamed
    other = content | {"decisions": content["decisions"][:4]}
    status, body = ask(server, "POST", f"/demonstrations/{file}", json.dumps(other).encode())
    assert (status, json.loads(body)) == (400, {"error": f"{file} holds another demonstration."})
    missing = "/demonstrations/demonstration-0002.json"
    assert ask(server, "POST", missing, json.dumps(content).encode())[0] == 400
    assert files(tmp_path) == [file]
    assert read_demonstration(tmp_path / file).model_dump() == renamed


def test_many_at_once_are_all_kept(server, tmp_path, content):
    body = json.dumps(content).encode()
    threads = [
        threading.Thread(target=ask, args=(server, "POST", "/demonstrations", body))
        for _ in range(12)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(files(tmp_path)) == 12


REFUSED = {
    "another page": ({"Origin": "http://evil.example"}, 403, "Only the page itself"),
    "a page of no origin": ({"Origin": "null"}, 403, "Only the page itself"),
    "a program": ({"Origin": None}, 403, "Only the page itself"),
    "a name that points here": (
        {"Host": "evil.example:80", "Origin": "http://evil.example:80"},
        403,
        "The page is at http://127.0.0.1",
    ),
    "no host": ({"Host": None}, 403, "The page is at"),
    "a form": ({"Content_Type": "text/plain"}, 415, "is JSON"),
    "no length": ({"Content_Length": None}, 411, "with its length"),
    "a negative length": ({"Content_Length": "-1"}, 411, "with its length"),
    "a long length": ({"Content_Length": "9" * 4000}, 413, "at most 16,384 bytes"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_the_page_is_refused(server, tmp_path, content, case):
    headers, status, sentence = REFUSED[case]
    found, body = ask(server, "POST", "/demonstrations", json.dumps(content).encode(), **headers)
    assert found == status
    assert sentence in json.loads(body)["error"]
    assert files(tmp_path) == []


def test_the_page_is_not_shown_under_another_name(server):
    status, body = ask(server, "GET", "/", Host=f"evil.example:{server.server_port}")
    assert status == 403
    assert PAGE not in body


@pytest.mark.parametrize(
    "path",
    [
        "/demonstrations/../x",
        "/demonstrations/demonstration-0001.json/../x",
        "/../../etc/passwd",
        "/index.html",
    ],
)
def test_there_is_nothing_else(server, path):
    assert ask(server, "GET", path)[0] == 404
    assert ask(server, "POST", path, b"{}")[0] == 404


def test_what_is_no_demonstration_gets_one_sentence(server, tmp_path, content):
    for body, sentence in (
        (b"[", "does not follow the format"),
        (json.dumps(content | {"decisions": [0, 2, 2003]}).encode(), "refuses decision 3"),
        (json.dumps(content | {"user": "<b>Ada</b>"}).encode(), "user: a name has words of"),
    ):
        status, answer = ask(server, "POST", "/demonstrations", body)
        assert status == 400
        assert sentence in json.loads(answer)["error"]
    assert files(tmp_path) == []


def test_a_study_takes_its_own_demonstrations_alone(server, tmp_path, content):
    server._study = "kitchen-2027"
    status, answer = ask(server, "POST", "/demonstrations", json.dumps(content).encode())
    assert status == 400
    assert "serves the study kitchen-2027, and not no study" in answer
    assert files(tmp_path) == []


def test_a_visitor_who_leaves_in_the_middle_disturbs_nobody(server, tmp_path, content, capfd):
    with socket.create_connection(("127.0.0.1", server.server_port)) as left:
        host = server.hosts[0]
        head = f"POST /demonstrations HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
        left.sendall(
            f"{head}Content-Type: application/json\r\nContent-Length: 900\r\n\r\n".encode()
        )
    assert ask(server, "POST", "/demonstrations", json.dumps(content).encode())[0] == 201
    assert files(tmp_path) == ["demonstration-0001.json"]
    assert "Traceback" not in capfd.readouterr().err


def test_a_taken_port_is_one_sentence(server, tmp_path):
    sentence = f"The port {server.server_port} is taken; give another --port."
    with pytest.raises(OSError, match=sentence):
        DemonstrationServer(PAGE, tmp_path, server.server_port, print)


PROGRAM = """
import signal, sys, types
# A shell's background job ignores Ctrl-C, and so would a program that the tests start there.
signal.signal(signal.SIGINT, signal.default_int_handler)
page = types.ModuleType("kitchen_prefs_demonstrations.page.building")
page.demonstration_page = lambda study, save_to: f"<title>{study} {save_to}</title>"
sys.modules["kitchen_prefs_demonstrations.page"] = types.ModuleType("page")
sys.modules["kitchen_prefs_demonstrations.page.building"] = page
from kitchen_prefs.cli import main
main()
"""


def run(*arguments, **options):
    command = [sys.executable, "-c", PROGRAM, *arguments]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


def test_the_command_says_what_is_saved_and_ends_with_control_c(tmp_path, content):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    started = run("demonstrate", f"--port={port}", "--out=kept", "--study=home", cwd=tmp_path)
    assert f"http://127.0.0.1:{port}/" in started.stdout.readline()
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", "/")
    assert connection.getresponse().read() == b"<title>home demonstrations</title>"
    headers = {"Origin": f"http://127.0.0.1:{port}", "Content-Type": "application/json"}
    participant = {"name": "home", "participant": "p1", "day": 1}
    shown = json.dumps(content | {"user": None, "study": participant})
    connection.request("POST", "/demonstrations", shown, headers)
    assert connection.getresponse().status == 201
    assert "demonstration-0001.json: home/p1, " in started.stdout.readline()
    started.send_signal(signal.SIGINT)
    said, errors = started.communicate(timeout=20)
    assert (started.returncode, errors) == (0, "")
    assert "Stopped" in said


def test_the_page_is_written_and_a_wrong_study_refused(tmp_path):
    written = run("demonstrate", "page", "--out=sub/page.html", cwd=tmp_path)
    refused = run("demonstrate", "page", "--out=other.html", "--study=<b>", cwd=tmp_path)
    assert written.communicate()[1] == ""
    assert "unlike '<b>'" in refused.communicate()[1]
    assert (tmp_path / "sub/page.html").read_text() == "<title>None None</title>"
    assert not (tmp_path / "other.html").exists()
