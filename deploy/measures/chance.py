"""What largest error over sigma to expect where every sigma is right: of so many estimates, each with a covariance from so many
blocks. Beside a limit of 4 it tells about how much of one row is chance: edges of a visit share captures and some leave
directions open, so that they are fewer than they seem."""
from .measure import info


def by_chance(context, name, blocks, rank, estimates):
    result = context.run_json("sigma_chance", blocks, rank, estimates)
    for kind, title in (("principal", "_sigmas"), ("axis", "_axis_sigmas")):
        yield info(name + title + "_by_chance_median", result[kind]["median"])
        yield info(name + title + "_by_chance_exceeded_by_5_percent", result[kind]["exceeded_by_5_percent"])
        yield info(name + title + "_by_chance_beyond_4", 100 * result[kind]["beyond_4_ratio"], "%")
