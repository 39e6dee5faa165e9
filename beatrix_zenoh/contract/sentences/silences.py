"""The sentences about requests without an answer, in each language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.sentences.language import Key

ENGLISH: Final[Mapping[Key, str]] = {
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
}

GERMAN: Final[Mapping[Key, str]] = {
    (Reason.NO_ANSWER, None, ""): ("Kein Roboter hat geantwortet. `beatrix ls` zeigt, welche da sind."),
    (Reason.NO_ANSWER, None, "alone"): (
        "{field} ist nicht da, und kein anderer Roboter ist es. Starte ihn mit `beatrix sim` oder `beatrix hw`."
    ),
    (Reason.NO_ANSWER, None, "alone in class"): (
        "{field} ist nicht da, und kein anderer Roboter ist es. Das Konto {holder} darf ihn nicht starten: Frage die "
        "Lehrkraft."
    ),
    (Reason.NO_ANSWER, None, "absent in class"): (
        "{field} ist nicht da. Da sind: {known}. Das Konto {holder} darf ihn nicht starten: Frage die Lehrkraft, oder "
        "wähle mit --name und --on (in Python: name und side von Robot)."
    ),
    (Reason.NO_ANSWER, None, "absent"): (
        "{field} ist nicht da. Da sind: {known}. Starte ihn mit `beatrix sim` oder `beatrix hw`, oder wähle mit --name "
        "und --on (in Python: name und side von Robot)."
    ),
    (Reason.NO_ANSWER, None, "present"): (
        "{field} ist da, hat aber nicht geantwortet: Er startet oder schließt gerade, oder er hat eine andere Version. "
        "Versuche es wieder; hilft das nicht, starte ihn neu."
    ),
    (Reason.NO_SUCH_ROBOT, None, ""): (
        "Einen Roboter dieses Namens gibt es nicht. `beatrix ls` zeigt, welche da sind."
    ),
    (Reason.NO_SUCH_ROBOT, None, "absent"): (
        "{field} ist nicht da, und kein Roboter heißt so. Da sind: {known}. Wähle einen mit --name, oder starte deinen "
        "mit `beatrix sim` oder `beatrix hw`."
    ),
    (Reason.NODE_LOST, None, ""): (
        "Der Roboter ist nicht mehr da. Sieh dir die Ausgabe seines Knotens an, dann starte ihn wieder."
    ),
    (Reason.NODE_LOST, None, "robot"): (
        "{field} ist nicht mehr da: Sein Knoten ist abgestürzt, beendet oder eingefroren, oder er hat den Router "
        "verloren. Seine Arme halten von selbst an. Sieh dir die Ausgabe des Knotens an, dann starte ihn wieder."
    ),
    (Reason.NODE_LOST, None, "back"): (
        "{field} war während dieser Anfrage weg und ist wieder da: Sein Knoten war eingefroren oder wurde neu gestartet, oder "
        "er hatte den Router verloren. Seine Arme haben von selbst angehalten. Sieh dir die Ausgabe des Knotens an, dann "
        "versuche es wieder."
    ),
    (Reason.NODE_HANGS, None, ""): (
        "Der Roboter ist da, aber sein Knoten ist eingefroren. Beende den Knoten und starte ihn wieder."
    ),
    (Reason.NODE_HANGS, None, "robot"): (
        "{field} ist da, hat aber binnen {value} nicht geantwortet und sendet keine Positionen: Sein Knoten ist "
        "eingefroren, oder das Netz ist unterbrochen. Beende den Knoten und starte ihn wieder; bewegen sich die "
        "Arme, schalte ihren Strom aus."
    ),
    (Reason.TIMED_OUT, None, ""): ("Der Roboter hat nicht rechtzeitig geantwortet. Versuche es wieder."),
    (Reason.TIMED_OUT, None, "robot"): (
        "{field} hat binnen {value} nicht geantwortet: Er sendet Positionen, läuft also, ist aber stark beschäftigt. "
        "Versuche es wieder, oder warte länger auf die Antwort."
    ),
    (Reason.TIMED_OUT, None, "stop"): (
        "{field} hat binnen {value} nicht geantwortet: Er sendet Positionen, läuft also, ist aber stark beschäftigt. "
        "Sende STOP noch einmal; bewegen sich die Arme, schalte ihren Strom aus."
    ),
    (Reason.ACCESS_DENIED, None, ""): (
        "Die Regeln des Routers erlauben diesem Konto diese Anfrage nicht. Frage die Lehrkraft."
    ),
    (Reason.ACCESS_DENIED, None, "robot"): (
        "{field} ist da, aber der Router lehnt diese Anfrage ab: Das Konto {holder} darf sie nicht senden. Ein Platz "
        "steuert die Roboter der Klasse und seinen eigenen; wähle einen davon mit --name. STOP steht jedem Platz offen."
    ),
    (Reason.ACCOUNT_REFUSED, None, ""): (
        "Der Router nimmt das Konto dieses Programms nicht an. Benutze die Datei deines Platzes: `beatrix join DATEI`."
    ),
    (Reason.NO_ROUTER, None, ""): (
        "An dieser Adresse ist kein Zenoh-Router. Starte einen mit `beatrix router`."
    ),
}
