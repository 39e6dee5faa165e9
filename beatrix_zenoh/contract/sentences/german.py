"""The sentences of refusals in German."""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract._generated.messages import Limit, Reason
from beatrix_zenoh.contract.sentences import silences
from beatrix_zenoh.contract.sentences.language import Language

_AT_REST = "Versuche es wieder, wenn die Arme ruhen."
_PAUSE = (
    "Sende {wait_s} lang keine Bewegung, dann versuche es wieder; jeder Versuch davor lässt das Warten neu beginnen. Ein "
    "Programm, das du jetzt startest, muss nicht warten."
)
_LONG_PAUSE = (
    "Sende {wait_s} lang keine Bewegung, dann versuche es wieder; jeder Versuch davor, auch der eines neuen Programms, "
    "lässt das Warten neu beginnen."
)
_TILT = "höchstens {high} sind erlaubt."
_GAP = "mindestens {low} sind nötig."
_YAW = "{low} bis {high} sind erlaubt."
_WAY = "Das Ziel ist erlaubt, aber auf dem Weg "

GERMAN: Final = Language(
    decimal=",",
    conjunction=" und ",
    arms={"short": "kurzen", "middle": "mittleren", "long": "langen"},
    commands={"RESET": "zurücksetzen", "ENABLE": "einschalten", "CALIBRATE": "kalibrieren"},
    leaves="Die Bewegung verlässt die Grenzen {leaves_s} nach ihrem Beginn, mit den Armen bei {leaves_arms}.",
    head="Versuche es mit yaw {yaw}, pitch {pitch}, roll {roll}.",
    position="Versuche es mit den Armen bei {position}.",
    speed="Versuche es mit der Geschwindigkeit {speed}.",
    nothing="Von hier aus wurde keine kürzere Bewegung gefunden, die erlaubt ist.",
    refusals={
        (Reason.OK, None, ""): "Erledigt.",
        (Reason.BAD_VALUE, None, ""): "Ein Feld der Anfrage fehlt, ist unbekannt oder nicht erlaubt.",
        (Reason.BAD_VALUE, None, "field"): "„{field}“ hat einen Wert, der nicht erlaubt ist.",
        (Reason.BAD_VALUE, None, "known"): "„{field}“ ist hier nicht erlaubt. Wähle eines von: {known}.",
        (Reason.BAD_VALUE, None, "wildcard"): (
            "„{field}“ trifft auf mehrere Roboter oder Anfragen zu. Sende dies an einen Schlüssel, zum Beispiel {known}; "
            "Platzhalter sind nur für STOP erlaubt."
        ),
        (
            Reason.BAD_VALUE,
            Limit.TILT,
            "",
        ): "„{field}“ ist {value}; mit diesen Stangen sind höchstens {high} möglich.",
        (Reason.BAD_VALUE, Limit.TRAVEL, "start"): (
            "Die Platine zählt {value} von der Grundstellung bis zum {arms} Arm; höchstens {high} sind möglich. Richte den "
            "Kopf auf und kalibriere."
        ),
        (Reason.BAD_VALUE, Limit.TRAVEL, "goal"): (
            "Zum {arms} Arm wären es {value} von der Grundstellung; höchstens {high} kann man der Platine senden. Richte "
            "den Kopf auf und kalibriere."
        ),
        (Reason.BAD_VALUE, Limit.SPEED, ""): (
            "Die Platine meldet {value} als Geschwindigkeit des {arms} Arms; höchstens {high} sind möglich. Richte den "
            "Kopf auf und kalibriere."
        ),
        (
            Reason.NOT_ENABLED,
            None,
            "",
        ): "Die Motoren sind aus. Richte den Kopf auf, schalte ein und kalibriere.",
        (Reason.NOT_ENABLED, None, "upright"): "Die Motoren sind aus. Den Kopf aufrichten, dann {needs}.",
        (Reason.NOT_CALIBRATED, None, ""): (
            "Die Grundstellung ist unbekannt. Kalibriere, wenn der Kopf aufrecht steht; sonst schalte aus, richte ihn auf, "
            "schalte ein und kalibriere."
        ),
        (Reason.NOT_CALIBRATED, None, "upright"): (
            "Die Grundstellung ist unbekannt. Wenn der Kopf aufrecht steht, {needs}; sonst ausschalten, ihn aufrichten, "
            "einschalten und kalibrieren."
        ),
        (
            Reason.OUT_OF_REACH,
            None,
            "",
        ): "Der Kopf kann diese Haltung nicht einnehmen. Wähle eine mit weniger Neigung.",
        (Reason.OUT_OF_REACH, Limit.TILT, "goal"): f"Der Kopf würde sich um {{value}} neigen; {_TILT}",
        (Reason.OUT_OF_REACH, Limit.TILT, "path"): f"{_WAY}würde sich der Kopf um {{value}} neigen; {_TILT}",
        (
            Reason.OUT_OF_REACH,
            Limit.TILT,
            "goal unfit",
        ): f"Mit den Armen am Ziel ist keine Kopfhaltung möglich; als Neigung {_TILT}",
        (
            Reason.OUT_OF_REACH,
            Limit.TILT,
            "path unfit",
        ): f"{_WAY}ist keine Kopfhaltung möglich; als Neigung {_TILT}",
        (Reason.OUT_OF_REACH, Limit.TILT, "start"): (
            "Mit den Armen bei {leaves_arms} ist keine Kopfhaltung möglich: Die gezählten Positionen sind falsch, oder der "
            "Hals ist durchgeschnappt. Schalte die Motoren aus, richte den Kopf auf, schalte ein und kalibriere."
        ),
        (
            Reason.ARM_GAP,
            None,
            "",
        ): "Zwei benachbarte Arme kämen einander zu nahe. Wähle eine andere Stellung.",
        (
            Reason.ARM_GAP,
            Limit.ARM_GAP,
            "goal",
        ): f"Zwischen dem {{arms}} Arm blieben {{value}}; {_GAP}",
        (
            Reason.ARM_GAP,
            Limit.ARM_GAP,
            "path",
        ): f"{_WAY}blieben zwischen dem {{arms}} Arm {{value}}; {_GAP}",
        (
            Reason.ARM_GAP,
            Limit.ARM_GAP,
            "goal crossed",
        ): f"Die Wege des {{arms}} Arms würden sich kreuzen; {_GAP}",
        (
            Reason.ARM_GAP,
            Limit.ARM_GAP,
            "path crossed",
        ): f"{_WAY}würden sich die Wege des {{arms}} Arms kreuzen; {_GAP}",
        (
            Reason.YAW_LIMIT,
            None,
            "",
        ): "Der Kopf würde sich weiter drehen, als seine Kabel erlauben. Drehe ihn weniger.",
        (Reason.YAW_LIMIT, Limit.YAW, "goal"): f"Der Kopf würde sich bis yaw {{value}} drehen; {_YAW}",
        (Reason.YAW_LIMIT, Limit.YAW, "path"): f"{_WAY}würde sich der Kopf bis yaw {{value}} drehen; {_YAW}",
        (Reason.YAW_LIMIT, Limit.TRAVEL, ""): (
            "Mit dem {arms} Arm ginge es bis {value}; da der Kopf sich nicht beliebig drehen darf, sind {low} bis {high} "
            "möglich."
        ),
        (
            Reason.SPEED_LIMIT,
            None,
            "",
        ): "Die Geschwindigkeit ist null, negativ oder über der Grenze. Wähle eine andere.",
        (
            Reason.SPEED_LIMIT,
            Limit.SPEED,
            "low",
        ): f"Eine Geschwindigkeit von {{value}} des {{arms}} Arms ist zu klein; {_YAW}",
        (
            Reason.SPEED_LIMIT,
            Limit.SPEED,
            "high",
        ): f"Eine Geschwindigkeit von {{value}} des {{arms}} Arms ist zu groß; {_YAW}",
        (Reason.SPEED_LIMIT, Limit.SPEED, "teacher"): (
            "Eine Geschwindigkeit von {value} des {arms} Arms ist zu groß: Es gilt die Grenze der Lehrkraft von {high}."
        ),
        (Reason.NOT_HOLDER, None, ""): "Ein anderer Platz steuert den Roboter. Versuche es später.",
        (Reason.NOT_HOLDER, None, "taken"): (
            "{holder} hat diesen Roboter genommen. Warte auf ihn mit `beatrix lease take --wait 60 --name ROBOTER`, "
            "wobei ROBOTER sein Name ist; STOP steht jedem Platz offen."
        ),
        (
            Reason.NOT_HOLDER,
            None,
            "ended",
        ): "Die Reservierung {value} ist beendet. Nimm den Roboter erneut, dann bewege ihn.",
        (
            Reason.FROZEN,
            None,
            "",
        ): "Die Lehrkraft hat diesen Roboter angehalten. Warte, bis sie ihn freigibt.",
        (Reason.FOLLOWING, None, ""): (
            "Die Simulation folgt dem Roboter und führt keine eigenen Bewegungen aus. Bewege den Roboter (--on hw), oder "
            "beende das mit `beatrix follow off`."
        ),
        (
            Reason.MUTED,
            None,
            "",
        ): "Die Lehrkraft hat diesen Platz stummgeschaltet: Er sieht nur zu. Bitte sie, ihn wieder zuzulassen.",
        (Reason.MUTED, None, "seat"): (
            "Die Lehrkraft hat {holder} stummgeschaltet: Dieser Platz sieht nur zu. Bitte sie, ihn mit `beatrix unmute "
            "{holder}` wieder zuzulassen."
        ),
        (Reason.MUTED, None, "stop"): (
            "Die Lehrkraft hat {holder} stummgeschaltet, und nichts von dir bewegt sich, also wurde nichts angehalten. "
            "Bitte sie, diesen Platz mit `beatrix unmute {holder}` wieder zuzulassen."
        ),
        (Reason.TEACHER_ONLY, None, "reset"): (
            "Die Lehrkraft hat EMERGENCY_STOP gedrückt, deshalb darf nur sie diesen Roboter zurücksetzen. Bitte sie, "
            "`beatrix reset` aufzurufen."
        ),
        (Reason.EMERGENCY, None, "teacher"): (
            "Die Lehrkraft hat EMERGENCY_STOP gedrückt, und die Motoren sind aus. Warte, bis sie den Roboter zurücksetzt."
        ),
        (Reason.TEACHER_ONLY, None, ""): "Nur die Lehrkraft darf diese Anfrage senden.",
        (
            Reason.TEACHER_ONLY,
            None,
            "seat",
        ): (
            "{holder} ist nicht der Platz der Lehrkraft: Nur `teacher` darf diese Anfrage senden. Setze als Lehrkraft "
            "BEATRIX_WHO=teacher; in einer Klasse rufe `beatrix join teacher.toml` auf."
        ),
        (Reason.NOT_HOLDER, None, "wait"): (
            "{holder} steuert diesen Roboter, der ruht. Versuche es in {wait_s} wieder; STOP darf jeder Platz senden."
        ),
        (Reason.NOT_HOLDER, None, "moving"): (
            "{holder} steuert diesen Roboter, und die Bewegung läuft. Versuche es nach ihr wieder; STOP darf jeder Platz "
            "senden."
        ),
        (
            Reason.NOT_AT_REST,
            None,
            "",
        ): "Die Arme bewegen sich. Warte, bis sie ruhen, oder sende STOP; versuche es dann wieder.",
        (
            Reason.HOME_KNOWN,
            None,
            "",
        ): "Die Grundstellung ist bekannt, und die Arme sind weit von ihr. Sende HOME, um sie anzufahren.",
        (Reason.HOME_KNOWN, Limit.HOME, ""): (
            "Die Grundstellung ist bekannt, und zum {arms} Arm sind es {value}; eine andere ist innerhalb von {high} "
            "erlaubt. Sende HOME, um sie anzufahren; für eine andere schalte aus, richte den Kopf auf und geradeaus, "
            "schalte ein und kalibriere."
        ),
        (Reason.BUSY, None, ""): "Zu viele Anfragen warten. Sende weniger in der Sekunde.",
        (
            Reason.BUSY,
            None,
            "moving",
        ): "Eine Bewegung von {holder} läuft. Versuche es wieder, wenn sie beendet ist.",
        (
            Reason.BUSY,
            Limit.QUEUE,
            "",
        ): "Die Warteschlange ist voll; höchstens {high} Anfragen dürfen warten. Sende weniger in der Sekunde.",
        (
            Reason.BOARD_LOST,
            None,
            "",
        ): "Die Platine antwortet ihrem Knoten nicht. Prüfe ihr Kabel und ihren Strom.",
        (
            Reason.HOST_LOST,
            None,
            "",
        ): "Die Platine hat zu lange nichts von ihrem Knoten empfangen und die Arme angehalten.",
        (
            Reason.CLIENT_LOST,
            None,
            "",
        ): "Die Sitzung, die diese Anfrage gesendet hat, ist beendet; deshalb bewegt sich der Roboter nicht.",
        (Reason.STOPPED, None, ""): f"STOP wurde gedrückt. {_AT_REST}",
        (Reason.STOPPED, None, "by"): f"STOP wurde von {{presser}} gedrückt. {_AT_REST}",
        (Reason.STOPPED, None, "wait"): f"STOP wurde gedrückt, während {{holder}} steuerte. {_PAUSE}",
        (Reason.STOPPED, None, "wait by"): (
            f"STOP wurde von {{presser}} gedrückt, während {{holder}} steuerte. {_PAUSE}"
        ),
        (Reason.STOPPED, None, "again"): (
            f"STOP wurde wieder gedrückt, während {{holder}} steuerte. {_LONG_PAUSE}"
        ),
        (Reason.STOPPED, None, "again by"): (
            f"STOP wurde wieder von {{presser}} gedrückt, während {{holder}} steuerte. {_LONG_PAUSE}"
        ),
        (
            Reason.REPLACED,
            None,
            "",
        ): "Eine neuere Bewegung dieses Platzes hat diese ersetzt, bevor sie begann.",
        (Reason.FAULT, None, ""): "Der Roboter meldet einen Fehler. Sieh dir seinen Status an.",
        (Reason.UNKNOWN_COMMAND, None, ""): "Diesen Befehl gibt es nicht.",
        (
            Reason.UNKNOWN_COMMAND,
            None,
            "number",
        ): "Den Befehl {value} gibt es nicht. Wähle einen von: {known}.",
        (
            Reason.UNKNOWN_COMMAND,
            None,
            "word",
        ): "Den Befehl „{field}“ gibt es nicht. Wähle einen von: {known}.",
        (
            Reason.EMERGENCY,
            None,
            "",
        ): "EMERGENCY_STOP ist eingerastet. Sieh nach dem Roboter, dann sende RESET.",
        (Reason.EMERGENCY, None, "upright"): (
            "EMERGENCY_STOP ist eingerastet, und die Motoren sind aus. Nach dem Roboter sehen und den Kopf aufrichten, dann "
            "{needs}; `beatrix reset` sendet RESET."
        ),
        (Reason.CONTRACT_MISMATCH, None, ""): (
            "Die Firmware hat eine andere Version als der Knoten oder wurde für einen anderen Roboter gebaut. Beende "
            "das Programm, das die Platine benutzt, dann rufe `beatrix flash` auf."
        ),
        (Reason.TIMED_OUT, Limit.DURATION, ""): (
            "Diese Bewegung würde {value} dauern; eine Vorschau umfasst höchstens {high}. Wähle eine höhere "
            "Geschwindigkeit oder eine kürzere Bewegung."
        ),
        (
            Reason.NAME_TAKEN,
            None,
            "",
        ): "Ein Roboter dieses Namens ist schon da. Wähle mit --name einen anderen Namen, oder beende den anderen.",
        (
            Reason.SHUTDOWN,
            None,
            "",
        ): "Der Knoten schließt. Starte ihn wieder, dann sende die Anfrage noch einmal.",
        **silences.GERMAN,
    },
)
