"""Wrong edges in a graph of 12 sensors and 59 edges: who is blamed, and what the result would be without them."""
from .measure import at_least, at_most, info


def run(context):
    result = context.run_json("graph_faults_measure")
    yield at_least("recall", result["recall"], 0.999)
    yield at_most("false_alarms", result["false_alarms"], 0.003)
    yield at_most("false_alarms_without_faults", result["false_alarms_without_faults"], 0.003)
    yield at_most("rms_over_oracle", result["rms_ratio"], 1.03)
    yield info("rms_over_oracle_worst_count", result["rms_ratio_worst"])
    yield at_least("consistent_recall", result["consistent_recall"], 0.95)
    yield info("consistent_false_alarms", result["consistent_false_alarms"])
    yield at_least("two_poses", result["two_poses"], 0.95)
