"""The paper's experiments on simulated truth; the page is written to build/measure/paper.html."""
from .measure import at_most, equal, info, within


def run(context):
    page = context.root / "build" / "measure" / "paper.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    noise = context.run_json("paper_experiment", "--out", page)["noise"]
    yield equal("noise_sets", noise["sets"], 300)
    yield within("whitened_ratio", noise["whitened_ratio"], 0.5, 0.02)
    yield at_most("whitened_ratio_largest", noise["whitened_ratio_largest"], 1.0)
    for part in ("translation", "rotation"):
        predicted = noise[part + "_ratio_predicted"]
        yield within(part + "_ratio", noise[part + "_ratio"], predicted, 0.03)
    yield info("page", page.relative_to(context.root))
