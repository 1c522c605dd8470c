"""Rigcal from Python: questions over HTTP (`Server`); pushes, and the calibration that a robot is to use, over DDS (`Client`)."""
from .client import Client, Follower
from .questions import Questions, Server
from .values import Calibration, Document, Edge, Lookup, Matrix, MeasuredPose, Pose, PushResult, RigcalError, SensorPose, Standing

__all__ = ["Calibration", "Client", "Document", "Edge", "Follower", "Lookup", "Matrix", "MeasuredPose", "Pose", "PushResult", "Questions",
           "RigcalError", "SensorPose", "Server", "Standing"]
