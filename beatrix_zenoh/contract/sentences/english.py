"""The sentences of refusals in English."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import Limit, Reason
from beatrix_zenoh.contract.sentences.templates import Language

_AT_REST = "Try again when the arms are at rest."
_PAUSE = (
    "Send no motion for {wait_s}, then try again; each earlier try restarts the wait. A program that you start now need "
    "not wait."
)
_LONG_PAUSE = (
    "Send no motion for {wait_s}, then try again; each earlier try, also of a new program, restarts the wait."
)
_LEAN = "at most {high} is allowed."
_GAP = "at least {low} is required."
_YAW = "{low} to {high} is allowed."
_PASSED = "The {arms} arms would pass each other; a gap of at least {low} is required."
_FAST = "A speed of {value} for the {arms} arm is too high: "
_WAY = "The goal is allowed, but on the way "

ENGLISH: Final = Language(
    decimal=".",
    minus="-",
    conjunction=" and ",
    arms={"short": "short", "middle": "middle", "long": "long"},
    commands={"RESET": "reset", "ENABLE": "enable", "CALIBRATE": "calibrate"},
    leaves="The motion leaves the limits {leaves_s} after its start, with the arms at {leaves_arms}.",
    head="Try moving to yaw {yaw}, pitch {pitch}, roll {roll}.",
    position="Try moving the arms to {position}.",
    speed="Try a speed of {speed}.",
    nothing="No shorter motion was found that is allowed from here.",
    refusals={
        (Reason.OK, None, ""): "Done.",
        (Reason.BAD_VALUE, None, ""): "A field of the request is missing, unknown or not allowed.",
        (Reason.BAD_VALUE, None, "field"): "'{field}' has a value that is not allowed.",
        (Reason.BAD_VALUE, None, "known"): "'{field}' is not allowed here. Choose one of: {known}.",
        (Reason.BAD_VALUE, None, "wildcard"): (
            "'{field}' matches several robots or requests. Send this to one key, for example {known}; wildcards are "
            "allowed only for STOP."
        ),
        (Reason.BAD_VALUE, Limit.TILT, ""): (
            "'{field}' is {value}; with these rods at most {high} is possible."
        ),
        (Reason.BAD_VALUE, Limit.TRAVEL, "start"): (
            "The board counts the {arms} arm at {value} from home; at most {high} is possible. Set the head upright and "
            "calibrate."
        ),
        (Reason.BAD_VALUE, Limit.TRAVEL, "goal"): (
            "The {arms} arm would be {value} from home; at most {high} can be sent to the board. Set the head upright "
            "and calibrate."
        ),
        (Reason.BAD_VALUE, Limit.SPEED, ""): (
            "The board reports a speed of {value} of the {arms} arm; at most {high} is possible. Set the head upright "
            "and calibrate."
        ),
        (Reason.NOT_ENABLED, None, ""): "The motors are off. Set the head upright, enable and calibrate.",
        (Reason.NOT_ENABLED, None, "upright"): "The motors are off. Set the head upright, then {needs}.",
        (Reason.NOT_CALIBRATED, None, ""): (
            "Home is not known. If the head is upright, calibrate; otherwise disable, set it upright, enable and calibrate."
        ),
        (Reason.NOT_CALIBRATED, None, "upright"): (
            "Home is not known. If the head is upright, {needs}; otherwise disable, set it upright, enable and calibrate."
        ),
        (Reason.OUT_OF_REACH, None, ""): "The head cannot take this pose. Choose one that leans less.",
        (Reason.OUT_OF_REACH, Limit.TILT, "goal"): f"The head would lean {{value}}; {_LEAN}",
        (Reason.OUT_OF_REACH, Limit.TILT, "path"): f"{_WAY}the head would lean {{value}}; {_LEAN}",
        (
            Reason.OUT_OF_REACH,
            Limit.TILT,
            "goal unfit",
        ): "No orientation of the head is possible with the arms at the goal; a lean of " + _LEAN,
        (
            Reason.OUT_OF_REACH,
            Limit.TILT,
            "path unfit",
        ): f"{_WAY}no orientation of the head is possible; a lean of {_LEAN}",
        (Reason.OUT_OF_REACH, Limit.TILT, "start"): (
            "No orientation of the head is possible with the arms at {leaves_arms}: the counted positions are wrong, or the "
            "neck has snapped through. Switch the motors off, set the head upright, switch them on and calibrate."
        ),
        (Reason.ARM_GAP, None, ""): "Two neighbouring arms would come too close. Choose another position.",
        (Reason.ARM_GAP, Limit.ARM_GAP, "goal"): f"The {{arms}} arms would be {{value}} apart; {_GAP}",
        (
            Reason.ARM_GAP,
            Limit.ARM_GAP,
            "path",
        ): f"{_WAY}the {{arms}} arms would be {{value}} apart; {_GAP}",
        (Reason.ARM_GAP, Limit.ARM_GAP, "goal crossed"): _PASSED,
        (Reason.ARM_GAP, Limit.ARM_GAP, "path crossed"): "The goal is allowed, but on the way t"
        + _PASSED[1:],
        (Reason.YAW_LIMIT, None, ""): "The head would turn further than its cables allow. Turn it less.",
        (Reason.YAW_LIMIT, Limit.YAW, "goal"): f"The head would turn to yaw {{value}}; {_YAW}",
        (Reason.YAW_LIMIT, Limit.YAW, "path"): f"{_WAY}the head would turn to yaw {{value}}; {_YAW}",
        (Reason.YAW_LIMIT, Limit.TRAVEL, ""): (
            "The {arms} arm would turn to {value}; the yaw limit of the head allows {low} to {high}."
        ),
        (Reason.SPEED_LIMIT, None, ""): "The speed is zero, negative or above the limit. Choose another.",
        (
            Reason.SPEED_LIMIT,
            Limit.SPEED,
            "low",
        ): "A speed of {value} for the {arms} arm is too low; {low} to {high} is allowed.",
        (
            Reason.SPEED_LIMIT,
            Limit.SPEED,
            "high",
        ): "A speed of {value} for the {arms} arm is too high; {low} to {high} is allowed.",
        (Reason.SPEED_LIMIT, Limit.SPEED, "teacher"): f"{_FAST}the teacher's limit of {{high}} applies.",
        (Reason.SPEED_LIMIT, Limit.SPEED, "turn"): f"{_FAST}in this turn at most {{high}} is allowed.",
        (Reason.SPEED_LIMIT, Limit.SPEED, "both"): f"{_FAST}teacher and turn both limit it to {{high}}.",
        (Reason.NOT_HOLDER, None, ""): "Another seat drives the robot. Try again later.",
        (Reason.NOT_HOLDER, None, "taken"): (
            "{holder} has taken this robot. Wait for it with `beatrix lease take --wait 60 --name ROBOT`, "
            "where ROBOT is its name; STOP is open to every seat."
        ),
        (Reason.NOT_HOLDER, None, "ended"): "Lease {value} has ended. Take the robot again, then move it.",
        (Reason.NOT_HOLDER, None, "skipped"): "The teacher has ended lease {value}. Wait for the teacher.",
        (Reason.FROZEN, None, ""): "The teacher has frozen this robot. Wait until the teacher unfreezes it.",
        (Reason.FOLLOWING, None, ""): (
            "The simulation follows the hardware and takes no motions of its own. Move the hardware (--on hw), or end this "
            "with `beatrix follow off`."
        ),
        (
            Reason.MUTED,
            None,
            "",
        ): "The teacher has muted this seat: it watches only. Ask the teacher to unmute it.",
        (Reason.MUTED, None, "seat"): (
            "The teacher has muted {holder}: this seat watches only. Ask the teacher, who unmutes it with `beatrix "
            "unmute {holder}`."
        ),
        (Reason.MUTED, None, "stop"): (
            "The teacher has muted {holder}, and nothing of yours moves, so nothing was stopped. Ask the teacher, who "
            "unmutes this seat with `beatrix unmute {holder}`."
        ),
        (Reason.TEACHER_ONLY, None, "reset"): (
            "The teacher has pressed EMERGENCY_STOP, so only the teacher may reset this robot. Ask the teacher, who "
            "types `beatrix reset`."
        ),
        (Reason.TEACHER_ONLY, None, ""): "Only the teacher may send this request.",
        (
            Reason.TEACHER_ONLY,
            None,
            "seat",
        ): (
            "{holder} is not the teacher's seat: only `teacher` may send this request. As the teacher, set "
            "BEATRIX_WHO=teacher; in a class, run `beatrix join teacher.toml`."
        ),
        (Reason.NOT_HOLDER, None, "wait"): (
            "{holder} drives this robot, which is at rest. Try again in {wait_s}; STOP is open to every seat."
        ),
        (Reason.NOT_HOLDER, None, "moving"): (
            "{holder} drives this robot and its motion is running. Try again after that motion; STOP is open to every seat."
        ),
        (
            Reason.NOT_AT_REST,
            None,
            "",
        ): "The arms are moving. Wait until they rest or send STOP, then try again.",
        (
            Reason.HOME_KNOWN,
            None,
            "",
        ): "Home is known, and the arms are far from it. Send HOME to move them home.",
        (Reason.HOME_KNOWN, Limit.HOME, ""): (
            "Home is known, and the {arms} arm is {value} from it; a new home is allowed within {high}. Send HOME to move "
            "home. To set a home further away, disable, set the head upright and straight ahead, enable and calibrate."
        ),
        (Reason.BUSY, None, ""): "Too many requests are waiting. Send fewer requests a second.",
        (Reason.BUSY, None, "moving"): "A motion of {holder} is running. Try again when it has ended.",
        (
            Reason.BUSY,
            Limit.QUEUE,
            "",
        ): "The queue is full; at most {high} requests may wait. Send fewer requests a second.",
        (
            Reason.BOARD_LOST,
            None,
            "",
        ): "The board does not answer its node. Check the cable and the board's power.",
        (
            Reason.HOST_LOST,
            None,
            "",
        ): "The board received no frame from its node for too long, and stopped the arms.",
        (
            Reason.CLIENT_LOST,
            None,
            "",
        ): "The session that sent this request has ended, so the robot does not move for it.",
        (Reason.STOPPED, None, ""): f"STOP was pressed. {_AT_REST}",
        (Reason.STOPPED, None, "by"): f"STOP was pressed by {{presser}}. {_AT_REST}",
        (Reason.STOPPED, None, "wait"): f"STOP was pressed while {{holder}} was driving. {_PAUSE}",
        (
            Reason.STOPPED,
            None,
            "wait by",
        ): f"STOP was pressed by {{presser}} while {{holder}} was driving. {_PAUSE}",
        (
            Reason.STOPPED,
            None,
            "again",
        ): f"STOP was pressed again while {{holder}} was driving. {_LONG_PAUSE}",
        (Reason.STOPPED, None, "again by"): (
            f"STOP was pressed again by {{presser}} while {{holder}} was driving. {_LONG_PAUSE}"
        ),
        (Reason.REPLACED, None, ""): "A newer motion of this seat replaced this one before it began.",
        (Reason.FAULT, None, ""): "The robot reports a fault. Look at its status.",
        (Reason.UNKNOWN_COMMAND, None, ""): "There is no such command.",
        (Reason.UNKNOWN_COMMAND, None, "number"): "There is no command {value}. Choose one of: {known}.",
        (Reason.UNKNOWN_COMMAND, None, "word"): "There is no command '{field}'. Choose one of: {known}.",
        (Reason.EMERGENCY, None, ""): "EMERGENCY_STOP is latched. Look at the robot, then send RESET.",
        (Reason.EMERGENCY, None, "teacher"): (
            "The teacher has pressed EMERGENCY_STOP, and the motors are off. Wait until the teacher resets the robot."
        ),
        (Reason.EMERGENCY, None, "upright"): (
            "EMERGENCY_STOP is latched and the motors are off. Look at the robot and set the head upright, then "
            "{needs}; `beatrix reset` sends RESET."
        ),
        (Reason.CONTRACT_MISMATCH, None, ""): (
            "Firmware and node have different versions, or the firmware was built for another robot. Close the program "
            "that uses the board, then run `beatrix flash`."
        ),
        (Reason.TIMED_OUT, Limit.DURATION, ""): (
            "This motion would take {value}; a preview covers at most {high}. Choose a higher speed or a shorter "
            "motion."
        ),
        (
            Reason.NAME_TAKEN,
            None,
            "",
        ): "A robot of this name is already online. Choose another name with --name, or end the other robot.",
        (Reason.SHUTDOWN, None, ""): "The node is closing. Start it again, then repeat the request.",
        (Reason.NO_ANSWER, None, ""): ("No robot answered. Run `beatrix ls` to see which robots are online."),
        (Reason.NO_ANSWER, None, "alone"): (
            "{field} is not online, and no other robot is. Start it with `beatrix sim` or `beatrix hw`."
        ),
        (Reason.NO_ANSWER, None, "alone in class"): (
            "{field} is not online, and no other robot is. Account {holder} may not start it: ask the teacher."
        ),
        (Reason.NO_ANSWER, None, "absent in class"): (
            "{field} is not online. Online: {known}. Account {holder} may not start it: ask the teacher, or choose with "
            "--name and --on (in Python: name and side of Robot)."
        ),
        (Reason.NO_ANSWER, None, "absent"): (
            "{field} is not online. Online: {known}. Start it with `beatrix sim` or `beatrix hw`, or choose with --name "
            "and --on (in Python: name and side of Robot)."
        ),
        (Reason.NO_ANSWER, None, "present"): (
            "{field} is online but did not answer: it is just starting or closing, or it has another version. Try again; "
            "if that fails, restart it."
        ),
        (Reason.NO_SUCH_ROBOT, None, ""): (
            "There is no robot of this name. Run `beatrix ls` to see which robots are online."
        ),
        (Reason.NO_SUCH_ROBOT, None, "absent"): (
            "{field} is not online, and no robot has this name. Online: {known}. Choose one with --name, or start yours "
            "with `beatrix sim` or `beatrix hw`."
        ),
        (Reason.NODE_LOST, None, ""): (
            "The robot is no longer online. Look at the output of its node, then start it again."
        ),
        (Reason.NODE_LOST, None, "robot"): (
            "{field} is no longer online: its node has crashed or ended, or hangs, or has lost the router. Its arms stop by "
            "themselves. Look at the output of the node, then start it again."
        ),
        (Reason.NODE_LOST, None, "back"): (
            "{field} was lost during this request and is online again: its node hung or was restarted, or had lost the "
            "router. Its arms have stopped by themselves. Look at the output of the node, then try again."
        ),
        (Reason.NODE_HANGS, None, ""): (
            "The robot is online, but its node hangs. End the node and start it again."
        ),
        (Reason.NODE_HANGS, None, "robot"): (
            "{field} is online but did not answer within {value}, and publishes no positions: its node hangs, or the "
            "network is interrupted. End the node and start it again; if the arms move, switch their power off."
        ),
        (Reason.TIMED_OUT, None, ""): ("The robot did not answer in time. Try again."),
        (Reason.TIMED_OUT, None, "robot"): (
            "{field} did not answer within {value}: it publishes positions, so it is running but very busy. Try again, or "
            "wait longer for the answer."
        ),
        (Reason.TIMED_OUT, None, "stop"): (
            "{field} did not answer within {value}: it publishes positions, so it is running but very busy. Send STOP "
            "again; if the arms move, switch their power off."
        ),
        (Reason.ACCESS_DENIED, None, ""): (
            "The access rules of the router refuse this request from this account. Ask the teacher."
        ),
        (Reason.ACCESS_DENIED, None, "robot"): (
            "{field} is online, but the router refuses this request: account {holder} may not send it. A seat drives "
            "the robots of the class and its own; choose one of these with --name. STOP is open to every seat."
        ),
        (Reason.ACCOUNT_REFUSED, None, ""): (
            "The router does not accept the account of this program. Use the file of your seat: `beatrix join FILE`."
        ),
        (Reason.NO_ROUTER, None, ""): (
            "There is no Zenoh router at this endpoint. Start one with `beatrix router`."
        ),
    },
)
