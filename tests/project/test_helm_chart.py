"""The Helm chart: valid values, hardened pods, and settings that the server accepts.

The templates use values, the name of the release, ``if`` and ``quote`` only, which are filled in
here; Helm is not needed.
"""

from __future__ import annotations

import copy
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import postgresql as postgresql_server
import pytest
from ruamel.yaml import YAML

from flexsid.settings import Mode, read_settings
from flexsid.storage.copies import backup as copies

CHART = Path(__file__).parents[2] / "deploy" / "helm" / "flexsid"
SITE = {"image": "flexsid:1", "host": "flexsid.example.org", "proxies": "10.0.0.0/24"}
EXPRESSION = re.compile(r"\{\{ (\.[\w.]+)( \| quote)? \}\}")
BRANCH = re.compile(r"\{\{- (?:if (not )?(\.[\w.]+)|(else)|(end)) \}\}\n?")


@pytest.fixture(scope="module")
def objects() -> dict[tuple[str, str], dict[str, Any]]:
    """Objects of the chart with its defaults, by kind and name without the release."""
    return render(SITE)


def test_defaults_of_the_chart_have_to_be_completed() -> None:
    schema = json.loads((CHART / "values.schema.json").read_text())
    jsonschema.validate(_values(SITE), schema)
    for name in SITE:
        incomplete = {key: value for key, value in SITE.items() if key != name}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(_values(incomplete), schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(_values({**SITE, "replica": 2}), schema)


def test_it_has_every_service(objects: dict[tuple[str, str], dict[str, Any]]) -> None:
    assert {key for key in objects if key[0] in ("Deployment", "StatefulSet", "CronJob")} == {
        ("Deployment", "web"),
        ("Deployment", "scheduler"),
        ("Deployment", "worker"),
        ("StatefulSet", "database"),
        ("CronJob", "backup"),
    }
    external = render({**SITE, "database": {"host": "db.example.org"}})
    assert not any(name == "database" for kind, name in external)
    address = _environment(_containers(external["Deployment", "web"])[0])["FLEXSID_DATABASE"]
    assert address == "postgresql://flexsid:$(DB_PASSWORD)@db.example.org:5432/flexsid"


def test_pods_are_hardened(objects: dict[tuple[str, str], dict[str, Any]]) -> None:
    pods = [(key, pod) for key, item in objects.items() for pod in _pods(item)]
    assert len(pods) == 5
    for key, pod in pods:
        assert pod["automountServiceAccountToken"] is False, key
        assert pod["enableServiceLinks"] is False, key
        assert pod["securityContext"]["runAsNonRoot"] is True, key
        assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}, key
        (container,) = pod["containers"]
        assert container["securityContext"] == {
            "allowPrivilegeEscalation": False,
            "readOnlyRootFilesystem": True,
            "capabilities": {"drop": ["ALL"]},
        }, key
        assert container["resources"]["limits"]["memory"], key
        volumes = {volume["name"] for volume in pod["volumes"]}
        claimed = objects[key]["spec"].get("volumeClaimTemplates", [])
        volumes |= {claim["metadata"]["name"] for claim in claimed}
        assert {mount["name"] for mount in container["volumeMounts"]} == volumes, key


def test_it_contains_no_secret(objects: dict[tuple[str, str], dict[str, Any]]) -> None:
    assert not any(kind == "Secret" for kind, _ in objects)
    for item in objects.values():
        for container in _containers(item):
            for variable in container.get("env", ()):
                if re.search("SECRET|PASSWORD", variable["name"]):
                    assert "secretKeyRef" in variable["valueFrom"], variable


@pytest.mark.parametrize("mode", [Mode.TEAM, Mode.ORGANISATION])
def test_the_server_accepts_the_settings(mode: Mode) -> None:
    openid = {"issuer": "https://id.example.org", "clientId": "flexsid"}
    organisation = {"openid": openid} if mode is Mode.ORGANISATION else {}
    found = render({**SITE, "mode": mode.value, **organisation})
    (web,) = _containers(found["Deployment", "web"])
    settings = read_settings(_environment(web))
    assert settings.mode is mode
    assert settings.is_secure
    assert settings.is_proxy("10.0.0.7")
    assert not settings.is_proxy("10.0.1.7")
    assert (settings.openid is not None) == (mode is Mode.ORGANISATION)
    assert settings.dask == f"tls://flexsid-scheduler:{_port(found, 'scheduler')}"
    assert _environment(web)["FLEXSID_PORT"] == str(web["ports"][0]["containerPort"])


def test_only_what_needs_it_reaches_dask_and_the_database(
    objects: dict[tuple[str, str], dict[str, Any]],
) -> None:
    admitted = {
        name: {
            peer["podSelector"]["matchLabels"]["app.kubernetes.io/component"]
            for rule in item["spec"]["ingress"]
            for peer in rule["from"]
        }
        for (kind, name), item in objects.items()
        if kind == "NetworkPolicy" and name != "web"
    }
    assert admitted == {
        "scheduler": {"web", "worker"},
        "worker": {"scheduler", "web", "worker"},
        "database": {"web", "backup"},
    }
    for name in ("scheduler", "worker"):
        (container,) = _containers(objects["Deployment", name])
        assert _environment(container)["DASK_CONFIG"] == "/cluster/cluster.yaml"
        command = container["command"]
        assert command[command.index("--dashboard-address") + 1] == "127.0.0.1:0"


def test_only_the_ingress_reaches_the_servers(
    objects: dict[tuple[str, str], dict[str, Any]],
) -> None:
    policy = objects["NetworkPolicy", "web"]["spec"]
    namespace = {"kubernetes.io/metadata.name": "ingress-nginx"}
    (port,) = _containers(objects["Deployment", "web"])[0]["ports"]
    assert policy["ingress"] == [
        {
            "from": [{"namespaceSelector": {"matchLabels": namespace}}],
            "ports": [{"port": port["containerPort"]}],
        }
    ]
    (egress,) = policy["egress"]
    refused = [one["ipBlock"]["except"] for one in egress["to"] if "ipBlock" in one]
    assert refused == [["169.254.169.254/32"], ["fd00:ec2::254/128"]]
    outside = render({**SITE, "ingress": {"namespace": ""}})["NetworkPolicy", "web"]["spec"]
    assert "from" not in outside["ingress"][0]


def test_recordings_and_brokers_are_settings_of_the_server() -> None:
    given = {"recordings": "s3://bucket/flexsid", "brokers": "nats://broker.example.org"}
    (web,) = _containers(render({**SITE, **given})["Deployment", "web"])
    settings = read_settings(_environment(web))
    assert settings.recordings == given["recordings"]
    assert settings.brokers == (given["brokers"],)
    assert web["envFrom"] == [{"secretRef": {"name": "flexsid-recordings", "optional": True}}]
    schema = json.loads((CHART / "values.schema.json").read_text())
    with pytest.raises(jsonschema.ValidationError):  # a pod has no disk that others reach
        jsonschema.validate(_values({**SITE, "recordings": "file:///data"}), schema)


def test_a_backup_is_complete_before_an_earlier_one_is_deleted(
    objects: dict[tuple[str, str], dict[str, Any]],
    postgresql: postgresql_server.Cluster,
    tmp_path: Path,
) -> None:
    (container,) = _containers(objects["CronJob", "backup"])
    command = [part.replace("/backups", str(tmp_path)) for part in container["command"]]
    earlier = [tmp_path / f"{copies.SCHEDULED}{20200101 + k}-023000.db" for k in range(14)]
    for old in earlier:
        old.touch()

    def back_up(url: str) -> int:
        programs = Path(sys.executable).parent
        environment = {
            **os.environ,
            "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
            "FLEXSID_DATABASE": url,
        }
        return subprocess.run(command, env=environment, capture_output=True, check=False).returncode

    assert back_up(postgresql.url("no_such_database")) != 0
    assert sorted(tmp_path.iterdir()) == earlier
    assert back_up(postgresql.url("empty")) == 0
    *rest, made = sorted(tmp_path.iterdir())
    assert rest == earlier[1:]
    copies.check(made)


def render(site: dict[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """Objects of the chart for these values."""
    values = {"Values": _values(site), "Release": {"Name": "flexsid", "Namespace": "default"}}
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for file in sorted((CHART / "templates").glob("*.yaml")):
        text = EXPRESSION.sub(lambda match: _fill(values, match), _select(file.read_text(), values))
        assert "{{" not in text, file
        for item in YAML(typ="safe").load_all(text):
            if item is not None:
                key = (item["kind"], item["metadata"]["name"].removeprefix("flexsid-"))
                assert key not in found
                found[key] = item
    return found


def _values(site: dict[str, Any]) -> dict[str, Any]:
    values = YAML(typ="safe").load(CHART / "values.yaml")
    for name, value in site.items():
        if isinstance(value, dict):
            values[name] = {**values[name], **copy.deepcopy(value)}
        else:
            values[name] = value
    return values


def _select(text: str, values: dict[str, Any]) -> str:
    """Return the text of the branches that apply."""
    parts: list[str] = []
    applies = [True]
    position = 0
    for mark in BRANCH.finditer(text):
        if all(applies):
            parts.append(text[position : mark.start()])
        position = mark.end()
        inverse, name, other, _ = mark.groups()
        if name:
            applies.append(bool(_find(values, name)) != bool(inverse))
        elif other:
            applies[-1] = not applies[-1]
        else:
            applies.pop()
    return "".join(parts) + text[position:]


def _fill(values: dict[str, Any], match: re.Match[str]) -> str:
    found = _find(values, match[1])
    return json.dumps(str(found)) if match[2] else str(found)


def _find(values: dict[str, Any], name: str) -> object:
    found: Any = values
    for part in name[1:].split("."):
        found = found[part]
    return found


def _pods(item: dict[str, Any]) -> Iterator[dict[str, Any]]:
    spec = item.get("spec", {})
    spec = spec.get("jobTemplate", {}).get("spec", spec)
    if "containers" in spec.get("template", {}).get("spec", {}):
        yield spec["template"]["spec"]


def _containers(item: dict[str, Any]) -> list[dict[str, Any]]:
    return [container for pod in _pods(item) for container in pod["containers"]]


def _environment(container: dict[str, Any]) -> dict[str, str]:
    return {entry["name"]: entry.get("value", "secret" * 8) for entry in container["env"]}


def _port(found: dict[tuple[str, str], dict[str, Any]], name: str) -> int:
    return found["Service", name]["spec"]["ports"][0]["port"]
