"""Checks the Rust version that Cargo.toml promises: no dependency of the library or the command line may declare a newer
one, and where that toolchain is installed the crate is checked with it. (Clippy's incompatible_msrv holds the crate's own code
to it.)"""
import json
import subprocess
import sys


def version(text):
    return tuple(int(part) for part in (text + ".0.0").split(".")[:3])


metadata = json.loads(subprocess.check_output(["cargo", "metadata", "--format-version", "1", "--all-features"]))
packages = {package["id"]: package for package in metadata["packages"]}
root = packages[metadata["resolve"]["root"]]
promised = root["rust_version"]
nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
seen, open_ = set(), [root["id"]]
while open_:
    package = open_.pop()
    if package in seen:
        continue
    seen.add(package)
    for dep in nodes[package]["deps"]:
        if any(kind["kind"] != "dev" for kind in dep["dep_kinds"]):
            open_.append(dep["pkg"])
newer = [
    f"{packages[p]['name']} {packages[p]['version']} wants {packages[p]['rust_version']}"
    for p in seen
    if packages[p]["rust_version"] and version(packages[p]["rust_version"]) > version(promised)
]
if newer:
    sys.exit(f"Rust {promised} is promised, but " + ", ".join(sorted(newer)))
print(f"{len(seen)} packages build with Rust {promised} by their own word")
installed = subprocess.run(["rustup", "toolchain", "list"], capture_output=True, text=True).stdout
if any(line.startswith(promised) for line in installed.splitlines()):
    subprocess.check_call(["cargo", f"+{promised}", "check", "--all-features"])
