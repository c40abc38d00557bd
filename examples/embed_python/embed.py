"""Follows a recorded drive and prints each object's velocity with its covariance: embed.py DRIVE"""
import sys
import threading

import motorcade


def show(result: motorcade.Result) -> None:
    x, y, z = result.T_world_cam[:3, 3]
    print(f"{result.frame}: camera at {x:.2f} {y:.2f} {z:.2f} m")
    for thing in result.objects:
        v, c = thing.velocity_world_mps, thing.velocity_covariance
        print(f"  object {thing.id}: {thing.T_cam_body[2, 3]:.1f} m ahead, velocity {v[0]:.1f} {v[2]:.1f} m/s, "
              f"covariance {c[0, 0]:.3f} {c[0, 2]:.3f} {c[2, 2]:.3f}")


def feed(drive: motorcade.Recording, tracker: motorcade.Tracker) -> None:  # as a camera's thread would
    try:
        for pair in drive:
            tracker.push(*pair)
    finally:
        tracker.close()


drive = motorcade.Recording(sys.argv[1])
with motorcade.Tracker(drive.camera, policy="replay") as tracker:
    threading.Thread(target=feed, args=(drive, tracker)).start()
    for result in tracker:
        show(result)
