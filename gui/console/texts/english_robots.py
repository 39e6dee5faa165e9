"""English: conditions of robots, refusals of the window, and the banner."""

from __future__ import annotations

from typing import Final

ROBOTS: Final[dict[str, str]] = {
    # -- why something is off, or cannot be sent
    "off.unchecked": "Check Simulation, Hardware or both first: motions and commands go to the checked robots.",
    "off.no_plan": "No motion waits to be sent to the hardware.",
    "off.no_undo": "There is no motion to undo.",
    "off.no_pose": "There is no saved pose. Save one first.",
    "off.one_pose": "Save two poses or more to play them one after the other.",
    "off.no_position": "The present angles are unknown: no robot reports its position.",
    "off.no_router": "Recording needs a router, and none answers.",
    "off.starting": "A simulation is starting.",
    "off.playing": "{title} is playing: press STOP to end it.",
    "cannot.router": "Nothing was sent: no router answers at {endpoint}. Start a simulation here, or start the router.",
    "cannot.refused": "Nothing was sent: the router at {endpoint} does not accept the account of this window.",
    "cannot.sim": "Nothing was sent: the simulation of {robot} is not online. Start one here, or clear Simulation.",
    "cannot.hw": (
        "Nothing was sent: the hardware of {robot} is not online. Connect its cable and run `beatrix hw`, or clear "
        "Hardware."
    ),
    "cannot.position": (
        "Nothing was sent: no positions arrive, so the present angles of the arms are unknown. Wait for them, or choose "
        "relative mode."
    ),
    "cannot.pose": "There is no pose named '{name}'. Choose one from the list.",
    "cannot.name": "A pose needs a name. Type one and save again.",
    "cannot.poses": "There are no saved poses. Save one first.",
    "cannot.file": "The file needs a name. Choose one that ends in .csv.",
    "cannot.row": "This row cannot be sent again. Choose one of your own motions or commands.",
    # -- state of a robot
    "condition.absent": "not online",
    "condition.lost": "lost",
    "condition.silent": "silent",
    "condition.disabled": "motors off",
    "condition.not_calibrated": "not calibrated",
    "condition.ready": "ready",
    "condition.moving": "moving",
    "condition.driven": "driven by {holder}",
    "condition.follow_waiting": "waits for the robot",
    "condition.follow_approaching": "moves to the robot",
    "condition.follow_following": "follows the robot",
    "condition.follow_parted": "parted from the robot",
    "reason.follow": "The simulation follows the robot: move the robot alone. STOP of the simulation or `beatrix follow off` ends it.",
    "condition.emergency": "emergency stop",
    "condition.board_lost": "board lost",
    "condition.contract_mismatch": "wrong firmware",
    "condition.assembly_left": "neck put back",
    "condition.connecting": "connecting",
    "condition.fault": "fault: {name}",
    "reason.fault": "The robot runs another version and reports a fault that this window does not know.",
    "reason.connecting": "The window is looking for a router at {endpoint}.",
    "reason.no_router": "No router answers at {endpoint}, so no robot can be seen.",
    "reason.refused": "The router at {endpoint} does not accept the account of this window, so no robot can be seen.",
    "reason.lost": (
        "{robot} is no longer online: its node has crashed or ended, or hangs, or has lost the router. Its arms "
        "stop by themselves. Start the node again."
    ),
    "reason.absent_sim": "No simulation of {robot} is online. Start one on this computer.",
    "reason.absent_hw": (
        "No hardware of {robot} is online. Connect its cable, switch it on and run `beatrix hw` on its computer."
    ),
    "reason.starting": "The simulation is starting.",
    "reason.silent": (
        "The robot is online, but no positions arrive. Wait a moment; if nothing changes, restart it or check its network."
    ),
    "reason.stale": "The last positions are {seconds:.1f} s old. Wait a moment; if nothing changes, restart the robot.",
    "reason.disabled_sim": "The motors are off. Press Make ready: it enables and calibrates the simulation.",
    "reason.disabled_hw": "The motors are off. Set the head upright by hand, then press Enable.",
    "reason.not_calibrated": "Home is unknown. If the head stands upright and looks straight ahead, press Calibrate.",
    "reason.driven_moving": "{holder} is moving the robot. Wait until the motion ends; you can always press STOP.",
    "reason.driven": "{holder} drives the robot until two seconds after the last motion; you can always press STOP.",
    "reason.assembly_left": "The neck snapped out of its home assembly and was put back. Calibrate when it rests.",
    "next.start": "Start simulation",
    "next.start_tip": "Start a simulation on this computer, and a router if there is none.",
    "next.retry": "Retry",
    "next.retry_tip": "Look for the router again now.",
    "next.enable": "Enable",
    "next.enable_tip": "Switch the motors on. Set the head upright first.",
    "next.ready": "Make ready",
    "next.ready_tip": "Enable and calibrate, unless that is done already.",
    "next.calibrate": "Calibrate",
    "next.calibrate_tip": "Declare the present position home. The head has to stand upright and look straight ahead.",
    "next.reset": "Reset",
    "next.reset_tip": "Clear the emergency stop; the motors stay off. Look at the robot first.",
    "pill.details": "Board {name} at {port}, firmware {firmware}",
    "pill.camera": "{eye} eye: {source}, {hz:.0f} pictures a second",
    "pill.no_cameras": "no cameras",
    "eye.left": "left",
    "eye.right": "right",
    # -- banner
    "banner.connecting": "Looking for a router at {endpoint}.",
    "banner.no_router": "No router answers at {endpoint}. Start a simulation here, or start the router and try again.",
    "banner.refused": (
        "The router at {endpoint} refuses this window's account. Run `beatrix join SEAT.toml`, then restart the window."
    ),
    "banner.starting": "A simulation is starting on this computer.",
    "banner.no_robot": "No robot is online. Start a simulation here, or start a robot with `beatrix up`.",
    "banner.other_robots": "{robot} is not online, but other robots are. Choose one, or start a simulation here.",
    "banner.emergency": (
        "Emergency stop ({robots}): the motors are off. Look at the robot and set its head upright. Then press Reset, "
        "Enable and Calibrate."
    ),
    "banner.reset": "Reset {side}",
    "banner.choose": "Show {robot}",
    "banner.choose_tip": "Watch and drive {robot}.",
}
