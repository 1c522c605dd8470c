"""Every page in Chromium: works, is accessible, asks nobody else, runs nothing that a person typed."""
import shutil

from stage import Flow, fill, run_script, skip_without_browser


def main():
    skip_without_browser()
    with Flow() as flow:
        pictures = fill(flow)
        copy = flow.folder / "copy"
        shutil.copytree(flow.folder / "store" / "reports" / "rover" / "2", copy)
        run_script(flow, "pages.cjs", pictures=pictures, copy=str(copy))
    print("pages: good")


main()
