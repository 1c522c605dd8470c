"""Wrong edges in a graph of 12 sensors and 59 edges: who is blamed, and what the result would be without them."""
from ..measure import at_least, at_most, info


def run(context):
    result = context.run_json("graph_faults_measure", timeout=1800)
    yield at_least("recall", result["recall"], 0.999)
    yield at_most("false_alarms", result["false_alarms"], 0.003)
    yield at_most("false_alarms_without_faults", result["false_alarms_without_faults"], 0.003)
    yield at_most("rms_over_oracle", result["rms_ratio"], 1.03)
    yield info("rms_over_oracle_worst_count", result["rms_ratio_worst"])
    yield at_least("consistent_recall", result["consistent_recall"], 0.95)
    yield info("consistent_false_alarms", result["consistent_false_alarms"])
    yield at_least("two_poses", result["two_poses"], 0.95)
    # Information estimated from few blocks: each edge from a session of its own, from the plain scatter that somebody
    # else's blocks left (no blocks passed on), and all edges from one session of a camera rig. `verdict` is the robot's.
    for blocks in (13, 20, 40):
        for kind in ("sessions", "scatter", "rig"):
            of = lambda figure: result["%s_%d_%s" % (kind, blocks, figure)]
            name = "%s_%d_blocks" % (kind, blocks)
            yield at_least("recall_" + name, of("recall"), 0.999)
            yield at_most("false_alarms_" + name, of("false_alarms"), 0.003)
            yield at_most("false_alarms_without_faults_" + name, of("false_alarms_without_faults"), 0.003)
            yield info("rms_over_oracle_" + name, of("rms_ratio"))
            yield at_least("failing_verdicts_with_a_fault_" + name, of("verdict_of_one"), 0.999)
            yield at_most("failing_verdicts_without_faults_" + name, of("verdict_of_none"), 0.01)
            yield at_most("failing_loops_without_faults_" + name, of("loops_of_none"), 0.01)
