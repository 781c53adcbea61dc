"""How far a trajectory is from the truth, by `evo`.

ATE and RPE are those of Sturm, Engelhard, Endres, Burgard and Cremers, A Benchmark for the Evaluation of RGB-D SLAM Systems (2012).
"""

import copy

import numpy as np
from evo.core import metrics, sync
from evo.tools import file_interface

APART_S = 0.02
LEG_M = 1.0


def errors(recording, trajectory, has_scale):
    """Of a file of poses; nothing where there are none or too few. Trajectories without scale are fitted by a similarity."""
    if not trajectory.exists():
        return {}
    found = file_interface.read_tum_trajectory_file(trajectory)
    if found.num_poses < 5:
        return {}
    truth, found = sync.associate_trajectories(recording.truth(), found, max_diff=APART_S)
    fitted = copy.deepcopy(found)
    _, _, scale = fitted.align(truth, correct_scale=not has_scale)
    pair = (truth, fitted)
    away = metrics.APE(metrics.PoseRelation.translation_part)
    away.process_data(pair)
    return {
        "length_m": truth.path_length,
        "ate_cm": 100 * away.get_statistic(metrics.StatisticsType.rmse),
        "ate_max_cm": 100 * away.get_statistic(metrics.StatisticsType.max),
        "rpe_cm_per_m": 100 * by_leg(pair, metrics.PoseRelation.translation_part),
        "rpe_deg_per_m": by_leg(pair, metrics.PoseRelation.rotation_angle_deg),
        "end_cm": 100 * end(*pair),
        "scale": scale,
    }


def by_leg(pair, relation):
    """Root of the mean square over all legs of a metre."""
    leg = metrics.RPE(relation, LEG_M, metrics.Unit.meters, all_pairs=True)
    leg.process_data(pair)
    return leg.get_statistic(metrics.StatisticsType.rmse)


def end(truth, found):
    """Metres from where the last pose should be, seen from the first."""
    told, true = [np.linalg.inv(path.poses_se3[0]) @ path.poses_se3[-1] for path in (found, truth)]
    return np.linalg.norm((np.linalg.inv(true) @ told)[:3, 3])
