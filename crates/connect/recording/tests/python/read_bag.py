"""Reads a recording with `mcap`, `mcap-ros2-support` and `rosbags`, which share no code with the writer.

read_bag.py FILE: prints one JSON document on what is in it. Every message is decoded by two readers, and what one of them
read is written again and must be the same bytes.
read_bag.py --write N: prints N messages of each known type, as `TYPE HEX`, written by `rosbags` with random contents.
"""

import json
import random
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

KNOWN = [
    "sensor_msgs/msg/JointState",
    "tf2_msgs/msg/TFMessage",
    "visualization_msgs/msg/MarkerArray",
    "diagnostic_msgs/msg/DiagnosticArray",
    "std_msgs/msg/String",
]


def read(path):
    """Counts, schemas and values of a recording."""
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    store = get_typestore(Stores.EMPTY)
    factory = DecoderFactory()
    found = {"topics": {}, "same_bytes": 0, "hashes": 0, "first": {}}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found["profile"] = reader.get_header().profile
        found["attachments"] = {a.name: len(a.data) for a in reader.iter_attachments()}
        found["metadata"] = {m.name: m.metadata for m in reader.iter_metadata()}
        summary = reader.get_summary()
        found["indexed_messages"] = summary.statistics.message_count
        last = {}
        for schema, channel, message in reader.iter_messages():
            topic = found["topics"].setdefault(
                channel.topic,
                {"type": schema.name, "schema": schema.encoding, "encoding": channel.message_encoding, "count": 0},
            )
            topic["count"] += 1
            assert message.log_time >= last.get(channel.topic, 0), f"{channel.topic} goes back in time"
            last[channel.topic] = message.log_time
            if schema.name not in store.types:
                types = get_types_from_msg(schema.data.decode(), schema.name)
                store.register({name: fields for name, fields in types.items() if name not in store.types})
                own = "RIHS01_" + store.hash_rihs01(schema.name)[-64:]
                assert own == channel.metadata["topic_type_hash"], f"{schema.name}: {own}"
                if schema.name in jazzy.types:
                    assert store.hash_rihs01(schema.name) == jazzy.hash_rihs01(schema.name), schema.name
                    found["hashes"] += 1
            decoded = factory.decoder_for(channel.message_encoding, schema)(message.data)
            typed = store.deserialize_cdr(message.data, schema.name)
            assert bytes(store.serialize_cdr(typed, schema.name)) == bytes(message.data), f"{channel.topic}: other bytes"
            found["same_bytes"] += 1
            if channel.topic == "/elbowroom/tick":
                assert decoded.speed_override == typed.speed_override
                assert list(decoded.q) == list(typed.q)
                found["override_sum"] = found.get("override_sum", 0.0) + decoded.speed_override
            if channel.topic == "/tf_static":
                found["static_frames"] = [t.child_frame_id for t in decoded.transforms]
            if channel.topic == "/robot_description":
                found["description_bytes"] = len(decoded.data)
            if channel.topic == "/tf":
                for t in decoded.transforms:
                    q = t.transform.rotation
                    assert abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1) < 1e-9
    print(json.dumps(found))


def value(store, rng, kind):
    """A random value of a field's type, as rosbags describes it."""
    node, about = kind
    if node.name == "BASE":
        name = about[0]
        if name == "string":
            return "".join(rng.choice("aß_/ ") for _ in range(rng.randrange(12)))
        if name == "bool":
            return rng.random() < 0.5
        if name in ("float32", "float64"):
            return rng.choice([0.0, 0.5, -2.25, 1024.0])
        bits = {"byte": 8, "octet": 8, "char": 8}.get(name) or int(name.lstrip("uint"))
        return rng.randrange(2 ** (bits - 1))
    if node.name == "NAME":
        return message(store, rng, about)
    element, length = about
    count = length if node.name == "ARRAY" else rng.randrange(4)
    values = [value(store, rng, element) for _ in range(count)]
    if element[0].name == "BASE" and element[1][0] not in ("string", "bool"):
        import numpy

        return numpy.array(values, dtype={"byte": "uint8", "octet": "uint8"}.get(element[1][0], element[1][0]))
    return values


def message(store, rng, name):
    """A random message."""
    fields = store.fielddefs[name][1]
    return store.types[name](**{field: value(store, rng, kind) for field, kind in fields})


def write(count):
    """Random messages as hexadecimal digits."""
    store = get_typestore(Stores.ROS2_JAZZY)
    rng = random.Random(17)
    for name in KNOWN:
        for _ in range(count):
            print(name, bytes(store.serialize_cdr(message(store, rng, name), name)).hex())


if __name__ == "__main__":
    if sys.argv[1] == "--write":
        write(int(sys.argv[2]))
    else:
        read(sys.argv[1])
