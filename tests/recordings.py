"""Small logs of every format, by the format's own library: an angle at 100 Hz, a current at 50 Hz."""

from __future__ import annotations

import io
import json
import struct
import tempfile
from pathlib import Path

import numpy as np

T = np.arange(200) / 100.0
ANGLE = np.sin(T)
CURRENT = 2.0 * T[::2] + 1.0
"""Linear in time, so that a linear interpolation of it is exact."""


def npz_bytes() -> bytes:
    """A NumPy archive with a vector, a matrix and a structured array."""
    file = io.BytesIO()
    np.savez_compressed(file, time_s=T, angle=ANGLE, both=np.column_stack([ANGLE, -ANGLE]))
    return file.getvalue()


def hdf5_bytes() -> bytes:
    """An HDF5 file with groups, units and a link."""
    import h5py

    file = io.BytesIO()
    with h5py.File(file, "w") as h5:
        h5["drive/time"] = T
        angle = h5.create_dataset("drive/angle", data=np.degrees(ANGLE), compression="gzip")
        angle.attrs["units"] = "deg"
        h5["away"] = h5py.ExternalLink("elsewhere.h5", "/x")
    return file.getvalue()


def mdf_bytes() -> bytes:
    """An MDF 4 file with two groups, one channel behind a formula, and an attachment."""
    import asammdf

    with tempfile.TemporaryDirectory() as folder, asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(samples=ANGLE, timestamps=T, name="angle", unit="rad")])
        file.append(
            [
                asammdf.Signal(samples=CURRENT, timestamps=T[::2], name="current", unit="A"),
                asammdf.Signal(
                    samples=CURRENT, timestamps=T[::2], name="computed", conversion={"formula": "X1*2"}
                ),
            ]
        )
        file.attach(b"print('run')", file_name="run.py")
        path = Path(folder) / "log.mf4"
        file.save(path)
        return path.read_bytes()


def tdms_bytes() -> bytes:
    """A TDMS file with two waveforms."""
    from nptdms import ChannelObject, TdmsWriter

    file = io.BytesIO()
    with TdmsWriter(file) as writer:
        start = np.datetime64("2024-05-01T12:00:00")
        writer.write_segment(
            [
                ChannelObject(
                    "log",
                    "angle",
                    ANGLE,
                    {"wf_increment": 0.01, "wf_start_time": start, "unit_string": "rad"},
                ),
                ChannelObject("log", "current", CURRENT, {"wf_increment": 0.02, "wf_start_time": start}),
            ]
        )
    return file.getvalue()


def bag_bytes() -> bytes:
    """A ROS 2 bag of joint states and a temperature."""
    from rosbags.rosbag2 import Writer

    with tempfile.TemporaryDirectory() as folder:
        with Writer(Path(folder) / "bag", version=8) as writer:
            _write_ros(writer)
        (path,) = (Path(folder) / "bag").glob("*.db3")
        return path.read_bytes()


def mcap_bytes() -> bytes:
    """The same messages in MCAP, with their definitions."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    with tempfile.TemporaryDirectory() as folder:
        with Writer(Path(folder) / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            _write_ros(writer)
        (path,) = (Path(folder) / "bag").glob("*.mcap")
        return path.read_bytes()


def _write_ros(writer: object) -> None:
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    joints, number = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
    states = writer.add_connection("/joint_states", joints, typestore=store)  # pyright: ignore[reportAttributeAccessIssue]
    current = writer.add_connection("/current", number, typestore=store)  # pyright: ignore[reportAttributeAccessIssue]
    empty = np.zeros(0)
    for k, t in enumerate(T):
        time = 1_700_000_000_000_000_000 + round(1e9 * t)
        stamp = kinds["builtin_interfaces/msg/Time"](sec=time // 10**9, nanosec=time % 10**9)
        header = kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="base")
        message = kinds[joints](
            header=header,
            name=["elbow", "wrist"],
            position=np.array([ANGLE[k], -ANGLE[k]]),
            velocity=empty,
            effort=empty,
        )
        writer.write(states, time + 700, store.serialize_cdr(message, joints))  # pyright: ignore[reportAttributeAccessIssue]
        if k % 2 == 0:
            one = kinds[number](data=float(CURRENT[k // 2]))
            writer.write(current, time, store.serialize_cdr(one, number))  # pyright: ignore[reportAttributeAccessIssue]


def json_mcap_bytes() -> bytes:
    """An MCAP recording of JSON messages, with an attachment and a topic in another encoding."""
    from mcap.writer import Writer

    file = io.BytesIO()
    writer = Writer(file)
    writer.start()
    schema = writer.register_schema("drive", "jsonschema", b"{}")
    drive = writer.register_channel("/drive", "json", schema)
    other = writer.register_channel("/camera", "protobuf", schema)
    for k, t in enumerate(T):
        time = round(1e9 * t)
        writer.add_message(drive, time, json.dumps({"angle": ANGLE[k], "mode": "on"}).encode(), time)
    writer.add_message(other, 0, b"\x01", 0)
    writer.add_attachment(0, 0, "run.py", "text/x-python", b"raise SystemExit")
    writer.finish()
    return file.getvalue()


def ulog_bytes() -> bytes:
    """A ULog with two topics; pyulog reads a hand-made one and writes it anew."""
    import struct

    from pyulog import ULog

    def message(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<HB", len(content), kind[0]) + content

    raw = b"\x55\x4c\x6f\x67\x01\x12\x35\x01" + struct.pack("<Q", 0)
    raw += message(b"B", bytes(40))
    raw += message(b"F", b"drive:uint64_t timestamp;double angle;")
    raw += message(b"F", b"motor:uint64_t timestamp;double current;")
    raw += message(b"A", struct.pack("<BH", 0, 0) + b"drive") + message(
        b"A", struct.pack("<BH", 0, 1) + b"motor"
    )
    for k, t in enumerate(T):
        raw += message(b"D", struct.pack("<HQd", 0, round(1e6 * t), ANGLE[k]))
        if k % 2 == 0:
            raw += message(b"D", struct.pack("<HQd", 1, round(1e6 * t), CURRENT[k // 2]))
    with tempfile.TemporaryDirectory() as folder:
        first, again = Path(folder) / "first.ulg", Path(folder) / "again.ulg"
        first.write_bytes(raw)
        ULog(str(first)).write_ulog(str(again))
        return again.read_bytes()


def wpilog_bytes(*entries: tuple[str, str, list[tuple[int, bytes]]]) -> bytes:
    """A data log of WPILib of entries, each a name, a type, and times [us] with payloads."""

    def record(number: int, time: int, payload: bytes) -> bytes:
        return struct.pack("<BBIQ", 0x7C, number, len(payload), time) + payload

    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    found = b"WPILOG" + struct.pack("<HI", 0x0100, 5) + b"extra"
    for number, (name, kind, values) in enumerate(entries, start=1):
        start = b"\0" + struct.pack("<I", number) + text(name) + text(kind) + text("")
        found += record(0, 0, start) + b"".join(record(number, t, payload) for t, payload in values)
    return found


def robot_bytes() -> bytes:
    """A data log of WPILib with a number, a list, a text and a structure."""
    times = [2000 * k for k in range(len(T))]
    return wpilog_bytes(
        ("/angle", "double", [(t, struct.pack("<d", x)) for t, x in zip(times, ANGLE, strict=True)]),
        ("both", "float[]", [(t, struct.pack("<2f", x, -x)) for t, x in zip(times, ANGLE, strict=True)]),
        ("mode", "string", [(t, b"on") for t in times[::50]]),
        ("pose", "struct:Pose", [(t, bytes(24)) for t in times[::50]]),
    )


def bag1_bytes(angle: np.ndarray = ANGLE, speed: np.ndarray = -ANGLE) -> bytes:
    """A bag of ROS 1 with the states of a joint at 500 Hz."""
    import rosbags.rosbag1 as bags
    import rosbags.typesys as types

    store = types.get_typestore(types.Stores.ROS1_NOETIC)
    state, header, stamp = (
        store.types[name]
        for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.bag"
        with bags.Writer(path) as bag:
            topic = bag.add_connection("/joints", state.__msgtype__, typestore=store)
            for k, (x, v) in enumerate(zip(angle, speed, strict=True)):
                at = stamp(sec=100, nanosec=2_000_000 * k)
                message = state(
                    header=header(seq=k, stamp=at, frame_id=""),
                    name=["elbow"],
                    position=np.array([x]),
                    velocity=np.array([v]),
                    effort=np.array([]),
                )
                bag.write(topic, 1 + k, store.serialize_ros1(message, state.__msgtype__))
        return path.read_bytes()


def npy_bytes() -> bytes:
    """A NumPy array of two columns."""
    file = io.BytesIO()
    np.save(file, np.column_stack([T, ANGLE]))
    return file.getvalue()


def xlsx_bytes() -> bytes:
    """A workbook with a row of units."""
    import openpyxl

    file, book = io.BytesIO(), openpyxl.Workbook()
    sheet = book.worksheets[0]
    for row in (["t", "angle"], ["s", "rad"], *zip(T.tolist(), ANGLE.tolist(), strict=True)):
        sheet.append(list(row))
    book.save(file)
    return file.getvalue()


def scope_bytes() -> bytes:
    """Two groups of a scope, the second at half of the rate, with decimal commas between tabs."""
    slow = [f"\t{1e3 * t:g}\t{i:.4f}" for t, i in zip(T[::2], CURRENT, strict=True)]
    rows = [
        f"{1e3 * t:g}\t{x:.5f}{slow[k] if k < len(slow) else ''}"
        for k, (t, x) in enumerate(zip(T, ANGLE, strict=True))
    ]
    head = "Name\tscope\nName\tx\tName\ti\nSampleTime[ms]\t10\tSampleTime[ms]\t20\nUnit\t(rad)\tUnit\t(A)\n\n"
    return (head + "\n".join(rows).replace(".", ",") + "\n").encode()


def blanks_bytes() -> bytes:
    """Lines of settings, then values between blanks with a time of day."""
    rows = [f"12:00:{t:06.3f} {x:.5f} {k % 3}" for k, (t, x) in enumerate(zip(T, ANGLE, strict=True))]
    return ("Axis 1\nSamples 200\n\ntime angle mode\n" + "\n".join(rows) + "\n").encode()


def trace_bytes() -> bytes:
    """A trace of CODESYS with two variables."""
    head = "[key]; [value]\nVersion; 0x03050000\n"
    blocks = [
        f"{k}.Variable; A.x{k}\n{k}.Data; \n"
        + "".join(f"; {t:g}; {x:g}\n" for t, x in zip(T, ANGLE, strict=True))
        for k in range(2)
    ]
    return (head + "".join(blocks)).encode()
