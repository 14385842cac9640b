"""The manifests in deploy/kubernetes and the alarms in deploy/prometheus, as they can be judged without a cluster."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml

import treestroke
from treestroke.serve import STOP_SECONDS
from treestroke.service.dispatch import queue_figures
from treestroke.settings import Settings
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE

ROOT = Path(__file__).parents[1]
FILES = sorted((ROOT / "deploy" / "kubernetes").glob("*.yaml"))
OBJECTS: list[dict[str, Any]] = [one for file in FILES for one in yaml.safe_load_all(file.read_text())]
RULES = yaml.safe_load((ROOT / "deploy" / "prometheus" / "treestroke.rules.yaml").read_text())
VARIABLES = {f"TREESTROKE_{name.upper()}" for name in Settings.model_fields}
VERSIONS = ("1.30", "1.37")
"""The oldest and the newest Kubernetes that the manifests are for."""


def named(one: dict[str, Any]) -> str:
    return f"{one['kind']}-{one['metadata']['name']}"


def of_kind(*kinds: str) -> list[dict[str, Any]]:
    return [one for one in OBJECTS if one["kind"] in kinds]


def pod_of(one: dict[str, Any]) -> dict[str, Any]:
    """Return the template of an object's pods."""
    spec = one["spec"]["jobTemplate"]["spec"] if one["kind"] == "CronJob" else one["spec"]
    return dict(spec["template"])


PODS = {named(one): pod_of(one) for one in of_kind("Deployment", "Job", "CronJob")}


def test_there_is_every_part() -> None:
    assert set(PODS) == {
        "Deployment-treestroke-web",
        "Deployment-treestroke-worker",
        "Job-treestroke-migrate",
        "CronJob-treestroke-backup",
    }
    assert len(of_kind("Service", "Ingress", "PodDisruptionBudget", "NetworkPolicy", "ScaledObject")) == 9


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("one", [pytest.param(one, id=named(one)) for one in OBJECTS if one["kind"] != "ScaledObject"])
def test_it_is_what_the_schema_says(one: dict[str, Any], version: str) -> None:
    kubernetes_validate.validate(one, version, strict=True)
    assert one["kind"] == "Namespace" or one["metadata"]["namespace"] == "treestroke"


def test_every_variable_that_is_given_is_a_setting() -> None:
    given = {name for one in of_kind("ConfigMap", "Secret") for name in one.get("data", one.get("stringData", {}))}
    given |= {one["name"] for pod in PODS.values() for one in pod["spec"]["containers"][0].get("env", [])}
    assert {name for name in given if name.startswith("TREESTROKE_")} <= VARIABLES


def test_the_owner_of_the_tables_is_known_to_the_migration_alone() -> None:
    (owners,) = (one for one in of_kind("Secret") if "TREESTROKE_OWNER_DATABASE_URL" in one["stringData"])
    known = [name for name, pod in PODS.items() if owners["metadata"]["name"] in yaml.safe_dump(pod["spec"])]
    assert "treestroke-owner" in yaml.safe_dump(PODS["Job-treestroke-migrate"])
    assert known == ["Job-treestroke-migrate"]


@pytest.mark.parametrize("name", PODS)
def test_every_pod_is_bounded(name: str) -> None:
    spec = PODS[name]["spec"]
    (container,) = spec["containers"]
    user = re.search(r"--uid (\d+)", (ROOT / "Dockerfile").read_text())
    assert user is not None
    assert spec["securityContext"]["runAsNonRoot"] is True
    assert spec["securityContext"]["runAsUser"] == int(user[1])
    assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert container["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    assert spec["automountServiceAccountToken"] is False
    assert container["resources"]["limits"]["memory"]
    assert all("sizeLimit" in volume["emptyDir"] for volume in spec["volumes"] if "emptyDir" in volume)


@pytest.mark.parametrize("name", PODS)
def test_every_pod_runs_a_command_of_this_version(name: str) -> None:
    (container,) = PODS[name]["spec"]["containers"]
    assert container["image"].endswith(f"/treestroke:{treestroke.__version__}")
    assert container["command"][0] == "treestroke"
    assert f"`treestroke {container['command'][1]}`" in (ROOT / "docs" / "cli.md").read_text()
    # The root of a volume belongs to root: a folder below it is the service's alone.
    data = Path(of_kind("ConfigMap")[0]["data"]["TREESTROKE_DATA"])
    assert str(data.parent) in {mount["mountPath"] for mount in container["volumeMounts"]}


def test_only_web_processes_are_probed_and_workers_have_time_to_stop() -> None:
    web, worker = (PODS[f"Deployment-treestroke-{part}"]["spec"] for part in ("web", "worker"))
    probes = {key: value for key, value in web["containers"][0].items() if key.endswith("Probe")}
    paths = {key: probe["httpGet"]["path"] for key, probe in probes.items()}
    assert paths == {"startupProbe": "/livez", "livenessProbe": "/livez", "readinessProbe": "/readyz"}
    assert [key for key in worker["containers"][0] if key.endswith("Probe")] == []
    (waits,) = web["containers"][0]["lifecycle"]["preStop"]["exec"]["command"][1:]
    assert web["terminationGracePeriodSeconds"] > STOP_SECONDS + int(waits)
    assert worker["terminationGracePeriodSeconds"] > STOP_SECONDS


def test_ports_are_those_of_the_settings_and_go_by_names_that_exist() -> None:
    (web,) = PODS["Deployment-treestroke-web"]["spec"]["containers"]
    ports = {one["name"]: one["containerPort"] for one in web["ports"]}
    assert ports["http"] == Settings.model_fields["port"].default
    assert str(ports["metrics"]) == of_kind("ConfigMap")[0]["data"]["TREESTROKE_METRICS_PORT"]
    services = {one["metadata"]["name"]: one["spec"] for one in of_kind("Service")}
    assert {port["targetPort"] for spec in services.values() for port in spec["ports"]} == set(ports)
    (ingress,) = of_kind("Ingress")
    (path,) = ingress["spec"]["rules"][0]["http"]["paths"]
    backend = path["backend"]["service"]
    assert backend["port"]["name"] in {port["name"] for port in services[backend["name"]]["ports"]}
    assert ingress["spec"]["rules"][0]["host"] == of_kind("ConfigMap")[0]["data"]["TREESTROKE_HOSTS"]


def selected() -> Iterator[dict[str, str]]:
    """Yield the labels by which objects choose pods."""
    for one in of_kind("Service"):
        yield one["spec"]["selector"]
    for one in of_kind("Deployment", "PodDisruptionBudget"):
        yield one["spec"]["selector"]["matchLabels"]
    for one in of_kind("NetworkPolicy"):
        yield one["spec"]["podSelector"].get("matchLabels", {})


def test_labels_choose_pods_that_exist() -> None:
    labels = [pod["metadata"]["labels"] for pod in PODS.values()]
    assert [one for one in selected() if not any(one.items() <= of_pod.items() for of_pod in labels)] == []


def test_scaling_and_alarms_ask_for_figures_that_exist(database: Database) -> None:
    figures = {f"treestroke_{name}" for name in queue_figures(database.of(SERVICE))}
    (scaled,) = of_kind("ScaledObject")
    assert f"Deployment-{scaled['spec']['scaleTargetRef']['name']}" in PODS
    alarms = [rule for group in RULES["groups"] for rule in group["rules"]]
    queries = [scaled["spec"]["triggers"][0]["metadata"]["query"], *(rule["expr"] for rule in alarms)]
    asked = {name for query in queries for name in re.findall(r"treestroke_\w+", query)}
    assert asked <= figures
    assert len({rule["alert"] for rule in alarms}) == len(alarms)
    documented = (ROOT / "docs" / "operating.md").read_text()
    assert set(re.findall(r"`(treestroke_\w+)`", documented)) <= figures
    assert [rule["alert"] for rule in alarms if f"`{rule['alert']}`" not in documented] == []
