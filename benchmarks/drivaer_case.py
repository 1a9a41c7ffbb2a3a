"""benchmarks/drivaer.toml at other sizes and with its geometry elsewhere, for the scripts here."""
import json
import re
from pathlib import Path

CASE = Path(__file__).resolve().parent / "drivaer.toml"


def car_files(folder):
    return [Path(folder).resolve() / f"drivaer-{part}.obj.gz" for part in ("body", "frontWheels", "rearWheels")]


def write_case(target, factor=1.0, files=None, case=CASE):
    """Writes the case file with every cell size times the factor, and its geometry (or these files) by whole paths; gives the target."""
    text = re.sub(r"(?m)^(max|surface|size)(\s*=\s*)([0-9.eE+-]+)", lambda m: f"{m[1]}{m[2]}{float(m[3]) * factor!r}", case.read_text())
    if files:
        geometry = f"geometry = {json.dumps([str(f) for f in files])}"
        text = re.sub(r"geometry = \[.*?\]", lambda _: geometry, text, flags=re.S)
    else:
        text = re.sub(r'"(\.\./[^"]+)"', lambda m: json.dumps(str((case.parent / m[1]).resolve())), text)
    target.write_text(text)
    return target
