"""A Hugging Face hub for tests: the endpoints that its client really calls, on this machine.

They were found by running the client, huggingface_hub 1.33.0, against this server, which answers
any other by 501. Large files come by LFS where HF_HUB_DISABLE_XET=1 is set; otherwise the client
puts them into a Xet store, for which it gets a folder here, and the server sees their hashes alone.
"""

import base64
import hashlib
import json
import os
import re
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, unquote, urlsplit

import warm_python
import yaml

TOKENS = {"hf_of_ada": "ada", "hf_of_bob": "bob"}
LARGE = (".parquet", ".bz2")  # those of our suffixes that a new repository's .gitattributes names


@dataclass(frozen=True)
class Commit:
    """All files of a repository at one time, by their paths."""

    message: str
    description: str
    files: dict[str, bytes]

    @property
    def oid(self):
        names = [f"{path} {git_hash(content)}" for path, content in self.files.items()]
        return hashlib.sha1("\n".join([self.message, *names]).encode()).hexdigest()


@dataclass
class Repository:
    """A repository: what it was made with, the commits of main, the tags, the pull requests."""

    about: dict
    commits: list[Commit] = field(default_factory=lambda: [Commit("initial commit", "", {})])
    tags: dict[str, Commit] = field(default_factory=dict)
    pull_requests: list[Commit] = field(default_factory=list)

    @property
    def files(self):
        return self.commits[-1].files

    def at(self, revision):
        by_oid = {commit.oid: commit for commit in self.commits}
        named = {"main": self.commits[-1], **self.tags, **by_oid}
        if revision not in named:
            raise RefusalError(404, f"Invalid rev id: {revision}", "RevisionNotFound")
        return named[revision]


class RefusalError(Exception):
    """An answer that is an error."""

    def __init__(self, status, message, code=None, **content):
        super().__init__(message)
        self.status = status
        self.headers = {"X-Error-Message": message} | ({"X-Error-Code": code} if code else {})
        self.content = {"error": message, **content}


@dataclass
class Request:
    """What the client asks."""

    user: str | None  # whose token came with it
    query: dict[str, str]
    body: bytes

    @property
    def json(self):
        return json.loads(self.body)


class Hub:
    """The hub's state and its answers.

    Attributes:
        folder: Where the Xet store is.
        address: What HF_ENDPOINT is to be.
        repositories: By kind and name, such as ("datasets", "ada/dishes").
        asked: The method and path of each request.
        large: What came by LFS, by SHA-256.
        out_of_order: The status that answers all requests of a method.
    """

    def __init__(self, folder):
        self.folder = folder
        self.address = ""
        self.repositories = {}
        self.asked = []
        self.large = {}
        self.out_of_order = {}

    @property
    def xet_store(self):
        return f"local://{self.folder / 'xet'}"

    def answer(self, method, path, request):
        """The answer: bytes with headers, or what becomes JSON."""
        self.asked.append(f"{method} {path}")
        if method in self.out_of_order:
            raise RefusalError(self.out_of_order[method], "Out of order.")
        for pattern, endpoint in ENDPOINTS.items():
            if found := re.fullmatch(pattern, f"{method} {path}"):
                return endpoint(self, request, **found.groupdict())
        raise RefusalError(501, f"No endpoint for {method} {path}")

    def find(self, request, kind, repo_id):
        """A repository, if the asker may see it."""
        repository = self.repositories.get((kind, repo_id))
        owner = repo_id.split("/")[0]
        if repository and (owner == request.user or repository.about["visibility"] == "public"):
            return repository
        status = 404 if request.user else 401
        raise RefusalError(status, "Repository not found", "RepoNotFound")

    def create(self, request):
        about = {"visibility": "public", **request.json}
        owner, name, kind = about["organization"], about["name"], f"{about['type']}s"
        must_write(request, owner)
        url = f"{self.address}/{kind}/{owner}/{name}"
        if (kind, f"{owner}/{name}") in self.repositories:
            raise RefusalError(409, "You already created this repo", url=url)
        self.repositories[kind, f"{owner}/{name}"] = Repository(about)
        return {"url": url}

    def info(self, request, kind, repo_id, revision="main"):
        commit = self.find(request, kind, repo_id).at(unquote(revision))
        siblings = [{"rfilename": path} for path in commit.files]
        return {"id": repo_id, "sha": commit.oid, "siblings": siblings, "tags": []}

    def validate_yaml(self, request):
        header = re.match(r"---\n(.*?)\n---\n", request.json["content"], re.DOTALL)
        try:
            assert isinstance(yaml.safe_load(header[1]), dict)
        except (TypeError, AssertionError, yaml.YAMLError):
            raise RefusalError(
                400, "Invalid metadata", errors=[{"message": "No mapping."}]
            ) from None
        return {"errors": [], "warnings": []}

    def preupload(self, request, kind, repo_id, revision):
        files = self.find(request, kind, repo_id).at(revision).files
        must_write(request, repo_id.split("/")[0], "create_pr" in request.query)
        return {"files": [how_to_upload(file, files) for file in request.json["files"]]}

    def lfs_batch(self, request, kind, repo_id):
        assert request.user
        objects = []
        for wanted in request.json["objects"]:
            upload = {"upload": {"href": f"{self.address}/lfs/{wanted['oid']}"}}
            missing = wanted["oid"] not in self.large
            objects.append(wanted | ({"actions": upload} if missing else {}))
        return {"transfer": "basic", "objects": objects}

    def lfs_upload(self, request, oid):
        if hashlib.sha256(request.body).hexdigest() != oid:
            raise RefusalError(400, "These are other bytes.")
        self.large[oid] = request.body
        return {}

    def xet_token(self, request, kind, repo_id):
        assert request.user
        return {"accessToken": "any", "exp": int(time.time()) + 3600, "casUrl": self.xet_store}

    def commit(self, request, kind, repo_id, revision):
        repository = self.find(request, kind, repo_id)
        as_proposal = "create_pr" in request.query
        must_write(request, repo_id.split("/")[0], as_proposal)
        header, *changes = (json.loads(line) for line in request.body.splitlines())
        files = dict(repository.at(revision).files)
        files.update(self.content_of(change) for change in changes)
        about = header["value"]
        commit = Commit(about["summary"], about["description"], files)
        url = f"{self.address}/{kind}/{repo_id}"
        answer = {
            "success": True,
            "commitOid": commit.oid,
            "commitUrl": f"{url}/commit/{commit.oid}",
        }
        if not as_proposal:
            repository.commits.append(commit)
            return answer
        repository.pull_requests.append(commit)
        return answer | {"pullRequestUrl": f"{url}/discussions/{len(repository.pull_requests)}"}

    def content_of(self, change):
        value = change["value"]
        if change["key"] == "lfsFile":
            return value["path"], self.large.get(value["oid"]) or pointer(value["oid"])
        assert change["key"] == "file"
        return value["path"], base64.b64decode(value["content"])

    def delete_tag(self, request, kind, repo_id, tag):
        repository = self.find(request, kind, repo_id)
        must_write(request, repo_id.split("/")[0])
        if tag not in repository.tags:
            raise RefusalError(404, "No such tag", "RevisionNotFound")
        del repository.tags[tag]
        return {}

    def create_tag(self, request, kind, repo_id, revision):
        repository = self.find(request, kind, repo_id)
        must_write(request, repo_id.split("/")[0])
        if request.json["tag"] in repository.tags:
            raise RefusalError(409, "Tag exists")
        repository.tags[request.json["tag"]] = repository.at(revision)
        return {}

    def refs(self, request, kind, repo_id):
        repository = self.find(request, kind, repo_id)
        main = {"name": "main", "ref": "refs/heads/main", "targetCommit": repository.at("main").oid}
        tags = [
            {"name": tag, "ref": f"refs/tags/{tag}", "targetCommit": commit.oid}
            for tag, commit in repository.tags.items()
        ]
        return {"branches": [main], "converts": [], "tags": tags}

    def tree(self, request, kind, repo_id, revision):
        files = self.find(request, kind, repo_id).at(revision).files
        return [
            {"type": "file", "path": path, "size": len(content), "oid": git_hash(content)}
            for path, content in files.items()
        ]

    def resolve(self, request, kind, repo_id, revision, path):
        commit = self.find(request, kind, repo_id).at(revision)
        content = commit.files.get(unquote(path))
        if content is None:
            raise RefusalError(404, "Entry not found", "EntryNotFound")
        return content, {"X-Repo-Commit": commit.oid, "ETag": f'"{git_hash(content)}"'}

    def resolve_model(self, request, repo_id, revision, path):
        return self.resolve(request, "models", repo_id, revision, path)


MODEL = r"(?P<repo_id>[^/]+/[^/]+)"  # a model's address has no kind
REPOSITORY = r"(?P<kind>datasets|spaces)/(?P<repo_id>[^/]+/[^/]+)"
ENDPOINTS = {
    # What pushing calls.
    r"GET /api/agent-harnesses": lambda hub, request: {"standardEnvVars": [], "harnesses": {}},
    r"POST /api/repos/create": Hub.create,
    rf"GET /api/{REPOSITORY}": Hub.info,
    r"POST /api/validate-yaml": Hub.validate_yaml,
    rf"POST /api/{REPOSITORY}/preupload/(?P<revision>main)": Hub.preupload,
    rf"POST /{REPOSITORY}\.git/info/lfs/objects/batch": Hub.lfs_batch,
    r"PUT /lfs/(?P<oid>[0-9a-f]{64})": Hub.lfs_upload,
    rf"GET /api/{REPOSITORY}/xet-write-token/(?:main|None)": Hub.xet_token,  # None: a pull request
    rf"POST /api/{REPOSITORY}/commit/(?P<revision>main)": Hub.commit,
    rf"GET /api/{REPOSITORY}/revision/(?P<revision>[^/]+)": Hub.info,
    rf"DELETE /api/{REPOSITORY}/tag/(?P<tag>[^/]+)": Hub.delete_tag,
    rf"POST /api/{REPOSITORY}/tag/(?P<revision>main)": Hub.create_tag,
    # What loading a data set calls, too.
    rf"GET /api/{REPOSITORY}/refs": Hub.refs,
    rf"GET /api/{REPOSITORY}/tree/(?P<revision>[^/]+)": Hub.tree,
    rf"(?:HEAD|GET) /{REPOSITORY}/resolve/(?P<revision>[^/]+)/(?P<path>.+)": Hub.resolve,
    # What downloading a checkpoint calls.
    rf"(?:HEAD|GET) /{MODEL}/resolve/(?P<revision>[^/]+)/(?P<path>.+)": Hub.resolve_model,
}


def must_write(request, owner, as_proposal=False):
    """Refuse who may not; a pull request may be anybody's."""
    if request.user is None:
        raise RefusalError(401, "Invalid username or password.")
    if request.user != owner and not as_proposal:
        raise RefusalError(403, f"You don't have the rights to write to {owner}.")


def how_to_upload(file, files):
    """Whether a file is large, and what the repository has in its place."""
    large = file["path"].endswith(LARGE)
    answer = {
        "path": file["path"],
        "uploadMode": "lfs" if large else "regular",
        "shouldIgnore": False,
    }
    there = files.get(file["path"])
    if there is None:
        return answer
    return answer | {"oid": hashlib.sha256(there).hexdigest() if large else git_hash(there)}


def pointer(oid):
    """What git has in place of a large file."""
    return f"version https://git-lfs.github.com/spec/v1\noid sha256:{oid}\n".encode()


def git_hash(content):
    return hashlib.sha1(b"blob %d\0" % len(content) + content).hexdigest()


class Handler(BaseHTTPRequestHandler):
    """Reads a request, lets the hub answer, writes the answer."""

    protocol_version = "HTTP/1.1"

    def __init__(self, hub, *arguments):
        self.hub = hub
        super().__init__(*arguments)

    def handle_request(self):
        url = urlsplit(self.path)
        token = self.headers.get("Authorization", "").removeprefix("Bearer ")
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        query = {name: values[0] for name, values in parse_qs(url.query).items()}
        request = Request(TOKENS.get(token), query, body)
        try:
            answer = self.hub.answer(self.command, url.path, request)
            content, headers = answer if isinstance(answer, tuple) else (to_json(answer), {})
            self.write(200, headers, content)
        except RefusalError as refusal:
            self.write(refusal.status, refusal.headers, to_json(refusal.content))

    do_GET = do_HEAD = do_POST = do_PUT = do_DELETE = handle_request  # noqa: N815

    def write(self, status, headers, content):
        self.send_response(status)
        for name, value in (headers | {"Content-Length": str(len(content))}).items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def log_message(self, *_):
        """Stay quiet."""


def to_json(content):
    return json.dumps(content).encode()


@contextmanager
def running_hub(folder):
    """A hub that answers until the end of the block."""
    hub = Hub(folder)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, hub))
    hub.address = f"http://127.0.0.1:{server.server_port}"
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield hub
    finally:
        server.shutdown()
        server.server_close()


def run(hub, *arguments, **environment):
    """Run Python with a hub in place of the real one, as ada and with nothing else of the hub's."""
    usual = {name: value for name, value in os.environ.items() if not name.startswith("HF_")}
    ours = {
        "HF_ENDPOINT": hub.address,
        "HF_HOME": str(hub.folder / "home"),
        "HF_TOKEN": "hf_of_ada",
        "HF_HUB_DISABLE_XET": "1",
        "HF_HUB_DISABLE_PROGRESS_BARS": "1",
        "NO_PROXY": "127.0.0.1",
    }
    return warm_python.run(*arguments, env=usual | ours | environment)


def kitchen_prefs(hub, *arguments, **environment):
    """Run `kitchen-prefs` so."""
    return run(hub, "-m", "kitchen_prefs.cli", *arguments, **environment)
