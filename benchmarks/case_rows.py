"""Rows of tables of cases: what a run's own report has, and what checkMesh says of its mesh."""
import os
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent


def checks_of(case):
    """Of the OpenFOAM case in a folder, by checkMesh -allTopology."""
    environment = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
    check = subprocess.run(["checkMesh", "-case", case, "-allTopology"], env=environment, capture_output=True, text=True)
    if check.returncode != 0:
        return f"no verdict, checkMesh ended with {check.returncode}"
    return "Mesh OK" if "Mesh OK." in check.stdout else "FAILS"


def row_of(name, report, seconds, verdict=None):
    q, f = report["quality"], report["fit"]
    return (f"| {name} | {report['cells']:,} | {seconds:.3g} | {report['peak_rss_bytes'] / 1e6:,.0f} MB "
            f"| {q['max_non_orthogonality']:.1f}, {q['max_skewness']:.2f} | {100 * f['wall_nodes_on_geometry_fraction']:.1f} % "
            f"| {f['mean_distance_in_h']:.3f} h | {100 * f['feature_capture_fraction']:.0f} % "
            f"| {100 * f['tilted_face_fraction']:.2g} % | {q['faces_beyond_limits'] or 'none'} |" + (f" {verdict} |" if verdict else ""))
