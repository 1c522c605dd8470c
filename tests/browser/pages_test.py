"""Every page in Chromium: works, is accessible, asks nobody else, runs nothing that a person typed."""
import shutil

from stage import Flow, edge, edge_file, fill, rover_edges, run_script, skip_without_browser


def main():
    skip_without_browser()
    with Flow() as flow:
        run_script(flow, "first.cjs", push=flow.server.client("push-edges", rover_edges(flow), "--robot", "rover"))
        pictures = fill(flow)
        archive, copy = flow.folder / "rover.zip", flow.folder / "copy"
        flow.rigcal("report", "rover", "--out", archive)
        shutil.unpack_archive(archive, copy)
        more = edge_file(flow, "more", [edge("base", "front", [1.0001, 0, 0])])
        run_script(flow, "pages.cjs", pictures=pictures, copy=str(copy / "rover-2"),
                   push=flow.server.client("push-edges", more, "--robot", "rover"))
    print("pages: good")


main()
