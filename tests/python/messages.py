"""Faults in files of ROS 2 messages."""

from mcap.reader import make_reader
from mcap.writer import Writer


def in_messages(name, change):
    """A change of the bytes of each message of a file, by its topic; the copy is not compressed."""

    def edited(folder):
        path = folder / name
        with path.open("rb") as file:
            reader = make_reader(file)
            records = list(reader.iter_messages())
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2", library="test")
            schemas, channels = {}, {}
            for schema, channel, message in records:
                if schema.id not in schemas:
                    schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
                if channel.id not in channels:
                    channels[channel.id] = writer.register_channel(channel.topic, "cdr", schemas[schema.id])
                data = change(channel.topic, message.data)
                writer.add_message(channels[channel.id], message.log_time, data, message.publish_time)
            writer.finish()

    return edited
