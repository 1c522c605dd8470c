"""The coloured cloud in Chromium: two million points, made here, on a page of a real server."""
from made_cloud import write_cloud
from stage import Flow, edge, push_edges, run_script, skip_without_browser, wait_published


def main():
    skip_without_browser()
    with Flow() as flow:
        push_edges(flow, "rover", [edge("base", "top", [1, 0, 0])])
        wait_published(flow)
        write_cloud(flow.folder / "store" / "reports" / "rover" / "1", 2_000_000)
        run_script(flow, "cloud.cjs", path="/robots/rover/revisions/1/", lidars=2)
    print("cloud: good")


main()
