"""Prints the messages of the original's client: of each field its number, name, type and the like."""

import json
import sys

from inspirai_fps.simple_command_pb2 import A2S_Reply_Data, S2A_Request_Data


def fields_of(message):
    return {
        field.number: {
            "name": field.name,
            "type": field.type,
            "repeated": field.label == field.LABEL_REPEATED,
            "values": field.enum_type
            and {value.name.upper(): value.number for value in field.enum_type.values},
            "fields": field.message_type and fields_of(field.message_type),
        }
        for field in message.fields
    }


sys.stdout.write(
    json.dumps(
        {"Request": fields_of(S2A_Request_Data.DESCRIPTOR), "Reply": fields_of(A2S_Reply_Data.DESCRIPTOR)}
    )
)
