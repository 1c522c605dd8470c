"""Reads an MCAP file by its own index alone, from the format's description: shares nothing with the writer under test."""
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS = 2, 3, 4, 5, 6, 7, 8, 11


class Damaged(Exception):
    pass


def need(condition, what):
    if not condition:
        raise Damaged(what)


def record_at(data, at, op):
    found, size = struct.unpack_from("<BQ", data, at)
    need(found == op and at + 9 + size <= len(data), "record %d at byte %d is %d" % (op, at, found))
    return data[at + 9:at + 9 + size]


def blocks(content, at, count):
    """`count` texts with their lengths before them, and where they end."""
    found = []
    for _ in range(count):
        size, = struct.unpack_from("<I", content, at)
        found.append(content[at + 4:at + 4 + size])
        at += 4 + size
    return found, at


def pairs(data, form):
    return [struct.unpack_from("<" + form, data, at) for at in range(0, len(data), struct.calcsize("<" + form))]


def records_between(data, at, end):
    while at < end:
        op, size = struct.unpack_from("<BQ", data, at)
        yield op, data[at + 9:at + 9 + size]
        at += 9 + size


def messages_of_chunk(data, entry):
    """[(channel, log_ns, publish_ns, bytes)] of a ChunkIndex's content."""
    _, _, offset, length = struct.unpack_from("<QQQQ", entry)
    (offsets,), at = blocks(entry, 32, 1)
    content = record_at(data, offset, CHUNK)
    need(length == len(content) + 9, "the length of a chunk")
    start_ns, end_ns, unpacked, crc = struct.unpack_from("<QQQI", content)
    (packing,), at = blocks(content, 28, 1)
    packed, = struct.unpack_from("<Q", content, at)
    records = content[at + 8:at + 8 + packed]
    need(packing == b"" and packed == unpacked == len(records) and crc == zlib.crc32(records), "a chunk's size and checksum")
    found = []
    for channel, index_at in pairs(offsets, "HQ"):
        index = record_at(data, index_at, MESSAGE_INDEX)
        need(struct.unpack_from("<H", index)[0] == channel, "the channel of an index")
        (rows,), _ = blocks(index, 2, 1)
        for log_ns, at in pairs(rows, "QQ"):
            message = record_at(records, at, MESSAGE)
            of, _, logged_ns, publish_ns = struct.unpack_from("<HIQQ", message)
            need(of == channel and logged_ns == log_ns and start_ns <= log_ns <= end_ns, "a message where its index has it")
            found.append((at, of, log_ns, publish_ns, message[22:]))
    return [row[1:] for row in sorted(found)]


def read(path):
    """[(topic, log_ns, publish_ns, bytes)] in the order of the file, {topic: (type, encoding of the definition, definition)}."""
    data = path.read_bytes()
    need(data.startswith(MAGIC) and data.endswith(MAGIC), "the marks at both ends")
    footer_at = len(data) - 8 - 29
    summary_start, _, _ = struct.unpack("<QQI", record_at(data, footer_at, FOOTER))
    schemas, channels, messages, told = {}, {}, [], None
    for op, content in records_between(data, summary_start, footer_at):
        if op == SCHEMA:
            schemas[struct.unpack_from("<H", content)[0]] = blocks(content, 2, 3)[0]
        elif op == CHANNEL:
            channel, schema = struct.unpack_from("<HH", content)
            (topic, encoding), _ = blocks(content, 4, 2)
            need(encoding == b"cdr", "messages are CDR")
            channels[channel] = (topic.decode(), schemas[schema])
        elif op == STATISTICS:
            told, = struct.unpack_from("<Q", content)
        elif op == CHUNK_INDEX:
            messages += messages_of_chunk(data, content)
    need(told == len(messages), "%d messages instead of %r" % (len(messages), told))
    topics = {topic: tuple(part.decode() for part in schema) for topic, schema in channels.values()}
    return [(channels[channel][0], *rest) for channel, *rest in messages], topics
