#!/usr/bin/env python3
"""What the Grafana dashboard shows of a machine, without Grafana: `tools/metrics` calls it with the address of a Prometheus.

- Each expression is evaluated by Prometheus over what it has read, as Grafana would send it: each has series, and their values are numbers.
- The file is read by Grafana's own model of a dashboard (grafana-foundation-sdk, made of Grafana's schemas) and its model of each panel's
  kind; what comes back is what stands in the file, so there is no field that Grafana does not know.

The library is installed below target/."""
import importlib
import json
import math
import pathlib
import subprocess
import sys
import urllib.parse
import urllib.request

root = pathlib.Path(__file__).resolve().parent.parent
venv = root / "target/metrics-venv"
if pathlib.Path(sys.prefix) != venv:
    python = venv / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", venv], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", "grafana-foundation-sdk==1769699998!10.1.0"], check=True)
    sys.exit(subprocess.run([python, __file__, *sys.argv[1:]]).returncode)

from grafana_foundation_sdk.cog.encoder import JSONEncoder
from grafana_foundation_sdk.models.dashboard import Dashboard

opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
# what Grafana puts in the place of its variables
VARIABLES = {"$instance": ".+", "$__range": "1h", "$__rate_interval": "10s"}


def evaluated(address, expression):
    """Series of an expression."""
    for name, value in VARIABLES.items():
        expression = expression.replace(name, value)
    assert "$" not in expression, expression
    query = urllib.parse.urlencode({"query": expression})
    with opener.open(f"http://{address}/api/v1/query?{query}", timeout=30) as answer:
        return json.load(answer)["data"]["result"]


def lost(here, there, path=""):
    """What stands here and not there."""
    if isinstance(here, dict) and isinstance(there, dict):
        return [one for key in here for one in (lost(here[key], there[key], f"{path}/{key}") if key in there else [f"{path}/{key}"])]
    if isinstance(here, list) and isinstance(there, list) and len(here) == len(there):
        return [one for index, (a, b) in enumerate(zip(here, there)) for one in lost(a, b, f"{path}/{index}")]
    return [] if here == there else [f"{path}: {here} is {there}"]


def model_of(kind):
    return importlib.import_module(f"grafana_foundation_sdk.models.{kind.replace('-', '')}")


def as_grafana(dashboard):
    """The dashboard through Grafana's model, back to JSON."""
    return json.loads(JSONEncoder().encode(Dashboard.from_json(dashboard)))


def known(dashboard):
    """Every field is known to Grafana's model."""
    unknown = lost(dashboard, as_grafana(dashboard))
    for panel in dashboard["panels"]:
        options = panel.get("options", {})
        back = json.loads(JSONEncoder().encode(model_of(panel["type"]).Options.from_json(options)))
        unknown += lost(options, back, f"/panels/{panel['id']}/options")
        query = importlib.import_module("grafana_foundation_sdk.models.prometheus").Dataquery
        for target in panel["targets"]:
            unknown += lost(target, json.loads(JSONEncoder().encode(query.from_json(target))), f"/panels/{panel['id']}/targets")
    return unknown


def main():
    dashboard = json.loads((root / "examples/monitoring/grafana.json").read_text(encoding="utf-8"))
    assert known(dashboard) == [], known(dashboard)
    wrong = json.loads(json.dumps(dashboard))
    wrong["panels"][0]["gridPos"]["wide"] = 6
    assert known(wrong) == ["/panels/0/gridPos/wide"], known(wrong)
    count = 0
    for panel in dashboard["panels"]:
        for target in panel["targets"]:
            found = evaluated(sys.argv[1], target["expr"])
            values = [float(series["value"][1]) for series in found]
            assert values and all(map(math.isfinite, values)), f"{panel['title']}: {target['expr']} gives {values}"
            count += 1
    print(f"dashboard: {len(dashboard['panels'])} panels as Grafana's model has them; each of {count} expressions gives numbers")


main()
