"""German: conditions of robots, refusals of the window, and the banner."""

from __future__ import annotations

from typing import Final

ROBOTS: Final[dict[str, str]] = {
    # -- why something is off, or cannot be sent
    "off.unchecked": (
        "Hake zuerst Simulation, Hardware oder beide an: Bewegungen und Befehle gehen dorthin, wo ein Haken ist."
    ),
    "off.no_plan": "Keine Bewegung wartet auf das Senden an die Hardware.",
    "off.no_undo": "Es gibt keine Bewegung, die rückgängig gemacht werden kann.",
    "off.no_pose": "Es gibt keine gespeicherte Pose. Speichere zuerst eine.",
    "off.one_pose": "Speichere zwei oder mehr Posen, um sie nacheinander abzuspielen.",
    "off.no_position": "Die Winkel sind unbekannt: Kein Roboter meldet, wo er ist.",
    "off.no_router": "Aufzeichnen braucht einen Router, und keiner antwortet.",
    "off.starting": "Eine Simulation startet gerade.",
    "off.playing": "{title} läuft: STOP beendet es.",
    "cannot.router": (
        "Nichts wurde gesendet: Unter {endpoint} antwortet kein Router. Starte hier eine Simulation oder den Router."
    ),
    "cannot.refused": "Nichts wurde gesendet: Der Router {endpoint} nimmt das Konto dieses Fensters nicht an.",
    "cannot.sim": (
        "Nichts wurde gesendet: Die Simulation von {robot} ist nicht da. Starte hier eine, oder nimm den Haken bei "
        "Simulation weg."
    ),
    "cannot.hw": (
        "Nichts wurde gesendet: Die Hardware von {robot} ist nicht da. Stecke ihr Kabel ein und rufe `beatrix hw` auf, "
        "oder nimm den Haken bei Hardware weg."
    ),
    "cannot.position": (
        "Nichts wurde gesendet: Die Winkel der Arme sind unbekannt, weil keine Positionen ankommen. Warte darauf, oder "
        "wähle den relativen Modus."
    ),
    "cannot.pose": "Es gibt keine Pose namens „{name}“. Wähle eine aus der Liste.",
    "cannot.name": "Eine Pose braucht einen Namen. Gib einen ein und speichere noch einmal.",
    "cannot.poses": "Es gibt keine gespeicherten Posen. Speichere zuerst eine.",
    "cannot.file": "Die Datei braucht einen Namen. Wähle einen, der auf .csv endet.",
    "cannot.row": "Diese Zeile kann nicht noch einmal gesendet werden. Wähle eine eigene Bewegung oder einen eigenen Befehl.",
    # -- state of a robot
    "condition.absent": "nicht da",
    "condition.lost": "verloren",
    "condition.silent": "stumm",
    "condition.disabled": "Motoren aus",
    "condition.not_calibrated": "nicht kalibriert",
    "condition.ready": "bereit",
    "condition.moving": "bewegt sich",
    "condition.driven": "{holder} steuert",
    "condition.follow_waiting": "wartet auf den Roboter",
    "condition.follow_approaching": "bewegt sich zum Roboter",
    "condition.follow_following": "folgt dem Roboter",
    "condition.follow_parted": "weicht vom Roboter ab",
    "reason.follow": (
        "Die Simulation folgt dem Roboter: Bewege nur den Roboter. Stopp der Simulation oder `beatrix follow off` beendet das."
    ),
    "condition.emergency": "Notstopp",
    "condition.board_lost": "Platine fehlt",
    "condition.contract_mismatch": "falsche Firmware",
    "condition.assembly_left": "Hals zurückgesetzt",
    "condition.connecting": "verbindet",
    "condition.fault": "Fehler: {name}",
    "reason.fault": "Der Roboter hat eine andere Version und meldet einen Fehler, den dieses Fenster nicht kennt.",
    "reason.connecting": "Das Fenster sucht einen Router unter {endpoint}.",
    "reason.no_router": "Unter {endpoint} antwortet kein Router, also ist kein Roboter zu sehen.",
    "reason.refused": (
        "Der Router {endpoint} nimmt das Konto dieses Fensters nicht an, also ist kein Roboter zu sehen."
    ),
    "reason.lost": (
        "{robot} war da und ist es nicht mehr: Sein Knoten ist abgestürzt, beendet oder eingefroren, oder er hat den Router "
        "verloren. Seine Arme halten von selbst an. Starte den Knoten wieder."
    ),
    "reason.absent_sim": "Keine Simulation von {robot} ist da. Starte eine auf diesem Rechner.",
    "reason.absent_hw": (
        "Keine Hardware von {robot} ist da. Stecke ihr Kabel ein, schalte sie an und rufe auf ihrem Rechner `beatrix hw` "
        "auf."
    ),
    "reason.starting": "Die Simulation startet gerade.",
    "reason.silent": (
        "Der Roboter ist da, aber es kommen keine Positionen an. Warte kurz; ändert sich nichts, starte ihn neu oder "
        "prüfe sein Netz."
    ),
    "reason.stale": (
        "Die letzten Positionen sind {seconds:.1f} s alt. Warte kurz; ändert sich nichts, starte den Roboter neu."
    ),
    "reason.disabled_sim": "Die Motoren sind aus. „Bereit machen“ schaltet sie ein und kalibriert.",
    "reason.disabled_hw": "Die Motoren sind aus. Richte den Kopf von Hand auf, dann schalte ein.",
    "reason.not_calibrated": (
        "Die Grundstellung ist unbekannt. Steht der Kopf aufrecht und blickt geradeaus, kalibriere."
    ),
    "reason.driven_moving": "{holder} bewegt den Roboter. Warte auf das Ende; STOP kannst du immer drücken.",
    "reason.driven": "{holder} steuert. Zwei Sekunden nach der letzten Bewegung ist der Roboter frei; STOP kannst du immer drücken.",
    "reason.assembly_left": (
        "Der Hals ist aus seiner Lage gesprungen und wurde zurückgesetzt. Kalibriere, wenn er ruht."
    ),
    "next.start": "Simulation starten",
    "next.start_tip": "Eine Simulation auf diesem Rechner starten, und einen Router, wenn es keinen gibt.",
    "next.retry": "Noch einmal",
    "next.retry_tip": "Den Router jetzt noch einmal suchen.",
    "next.enable": "Einschalten",
    "next.enable_tip": "Motoren an. Richte zuerst den Kopf auf.",
    "next.ready": "Bereit machen",
    "next.ready_tip": "Einschalten und kalibrieren, soweit es nötig ist.",
    "next.calibrate": "Kalibrieren",
    "next.calibrate_tip": "Die jetzige Stellung wird zur Grundstellung. Der Kopf muss aufrecht stehen und geradeaus blicken.",
    "next.reset": "Zurücksetzen",
    "next.reset_tip": "Den Notstopp aufheben; die Motoren bleiben aus. Sieh zuerst nach dem Roboter.",
    "pill.details": "Platine {name} an {port}, Firmware {firmware}",
    "pill.camera": "{eye} Auge: {source}, {hz:.0f} Bilder in der Sekunde",
    "pill.no_cameras": "keine Kameras",
    "eye.left": "linkes",
    "eye.right": "rechtes",
    # -- banner
    "banner.connecting": "Ein Router wird unter {endpoint} gesucht.",
    "banner.no_router": (
        "Unter {endpoint} antwortet kein Router. Starte hier eine Simulation, oder starte den Router und versuche es noch "
        "einmal."
    ),
    "banner.refused": (
        "Der Router {endpoint} nimmt dieses Konto nicht an. `beatrix join` mit der Datei deines Platzes, dann das Fenster neu "
        "starten."
    ),
    "banner.starting": "Eine Simulation startet auf diesem Rechner.",
    "banner.no_robot": "Kein Roboter ist da. Starte hier eine Simulation, oder einen Roboter mit `beatrix up`.",
    "banner.other_robots": (
        "{robot} ist nicht da, aber andere Roboter sind es. Wähle einen, oder starte hier eine Simulation."
    ),
    "banner.emergency": (
        "Notstopp ({robots}): Die Motoren sind aus. Sieh nach dem Roboter und richte seinen Kopf auf. Drücke dann "
        "Zurücksetzen, Einschalten und Kalibrieren."
    ),
    "banner.reset": "{side} zurücksetzen",
    "banner.choose": "{robot} zeigen",
    "banner.choose_tip": "{robot} ansehen und steuern.",
}
