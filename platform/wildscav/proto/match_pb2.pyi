from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class ClientMessage(_message.Message):
    __slots__ = ("join", "action", "ready")
    JOIN_FIELD_NUMBER: _ClassVar[int]
    ACTION_FIELD_NUMBER: _ClassVar[int]
    READY_FIELD_NUMBER: _ClassVar[int]
    join: Join
    action: Action
    ready: Ready
    def __init__(self, join: _Optional[_Union[Join, _Mapping]] = ..., action: _Optional[_Union[Action, _Mapping]] = ..., ready: _Optional[_Union[Ready, _Mapping]] = ...) -> None: ...

class ServerMessage(_message.Message):
    __slots__ = ("match_info", "observation", "match_over")
    MATCH_INFO_FIELD_NUMBER: _ClassVar[int]
    OBSERVATION_FIELD_NUMBER: _ClassVar[int]
    MATCH_OVER_FIELD_NUMBER: _ClassVar[int]
    match_info: MatchInfo
    observation: Observation
    match_over: MatchOver
    def __init__(self, match_info: _Optional[_Union[MatchInfo, _Mapping]] = ..., observation: _Optional[_Union[Observation, _Mapping]] = ..., match_over: _Optional[_Union[MatchOver, _Mapping]] = ...) -> None: ...

class Join(_message.Message):
    __slots__ = ("token", "protocol_version", "sdk_name", "sdk_version", "gets_ready")
    TOKEN_FIELD_NUMBER: _ClassVar[int]
    PROTOCOL_VERSION_FIELD_NUMBER: _ClassVar[int]
    SDK_NAME_FIELD_NUMBER: _ClassVar[int]
    SDK_VERSION_FIELD_NUMBER: _ClassVar[int]
    GETS_READY_FIELD_NUMBER: _ClassVar[int]
    token: str
    protocol_version: int
    sdk_name: str
    sdk_version: str
    gets_ready: bool
    def __init__(self, token: _Optional[str] = ..., protocol_version: _Optional[int] = ..., sdk_name: _Optional[str] = ..., sdk_version: _Optional[str] = ..., gets_ready: _Optional[bool] = ...) -> None: ...

class Ready(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class Action(_message.Message):
    __slots__ = ("step", "walk_direction", "walk_speed", "turn", "look", "jump", "pick_up", "shoot", "reload")
    STEP_FIELD_NUMBER: _ClassVar[int]
    WALK_DIRECTION_FIELD_NUMBER: _ClassVar[int]
    WALK_SPEED_FIELD_NUMBER: _ClassVar[int]
    TURN_FIELD_NUMBER: _ClassVar[int]
    LOOK_FIELD_NUMBER: _ClassVar[int]
    JUMP_FIELD_NUMBER: _ClassVar[int]
    PICK_UP_FIELD_NUMBER: _ClassVar[int]
    SHOOT_FIELD_NUMBER: _ClassVar[int]
    RELOAD_FIELD_NUMBER: _ClassVar[int]
    step: int
    walk_direction: float
    walk_speed: float
    turn: float
    look: float
    jump: bool
    pick_up: bool
    shoot: bool
    reload: bool
    def __init__(self, step: _Optional[int] = ..., walk_direction: _Optional[float] = ..., walk_speed: _Optional[float] = ..., turn: _Optional[float] = ..., look: _Optional[float] = ..., jump: _Optional[bool] = ..., pick_up: _Optional[bool] = ..., shoot: _Optional[bool] = ..., reload: _Optional[bool] = ...) -> None: ...

class Vector(_message.Message):
    __slots__ = ("x", "y", "z")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    x: float
    y: float
    z: float
    def __init__(self, x: _Optional[float] = ..., y: _Optional[float] = ..., z: _Optional[float] = ...) -> None: ...

class MatchInfo(_message.Message):
    __slots__ = ("protocol_version", "track", "seat", "seats", "team", "time_limit", "frames_per_action", "frames_per_second", "map_size", "start", "target", "supply_waves", "seed", "step_budget", "time_bank", "target_distance", "pick_up_distance", "supply_sight", "clip_size", "start_health", "respawns", "supply_goal", "senses", "turn_speed", "spread", "recoil", "walking_sway", "turning_sway", "bounty", "clock", "token_time", "processor_time")
    PROTOCOL_VERSION_FIELD_NUMBER: _ClassVar[int]
    TRACK_FIELD_NUMBER: _ClassVar[int]
    SEAT_FIELD_NUMBER: _ClassVar[int]
    SEATS_FIELD_NUMBER: _ClassVar[int]
    TEAM_FIELD_NUMBER: _ClassVar[int]
    TIME_LIMIT_FIELD_NUMBER: _ClassVar[int]
    FRAMES_PER_ACTION_FIELD_NUMBER: _ClassVar[int]
    FRAMES_PER_SECOND_FIELD_NUMBER: _ClassVar[int]
    MAP_SIZE_FIELD_NUMBER: _ClassVar[int]
    START_FIELD_NUMBER: _ClassVar[int]
    TARGET_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_WAVES_FIELD_NUMBER: _ClassVar[int]
    SEED_FIELD_NUMBER: _ClassVar[int]
    STEP_BUDGET_FIELD_NUMBER: _ClassVar[int]
    TIME_BANK_FIELD_NUMBER: _ClassVar[int]
    TARGET_DISTANCE_FIELD_NUMBER: _ClassVar[int]
    PICK_UP_DISTANCE_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_SIGHT_FIELD_NUMBER: _ClassVar[int]
    CLIP_SIZE_FIELD_NUMBER: _ClassVar[int]
    START_HEALTH_FIELD_NUMBER: _ClassVar[int]
    RESPAWNS_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_GOAL_FIELD_NUMBER: _ClassVar[int]
    SENSES_FIELD_NUMBER: _ClassVar[int]
    TURN_SPEED_FIELD_NUMBER: _ClassVar[int]
    SPREAD_FIELD_NUMBER: _ClassVar[int]
    RECOIL_FIELD_NUMBER: _ClassVar[int]
    WALKING_SWAY_FIELD_NUMBER: _ClassVar[int]
    TURNING_SWAY_FIELD_NUMBER: _ClassVar[int]
    BOUNTY_FIELD_NUMBER: _ClassVar[int]
    CLOCK_FIELD_NUMBER: _ClassVar[int]
    TOKEN_TIME_FIELD_NUMBER: _ClassVar[int]
    PROCESSOR_TIME_FIELD_NUMBER: _ClassVar[int]
    protocol_version: int
    track: str
    seat: int
    seats: int
    team: int
    time_limit: float
    frames_per_action: int
    frames_per_second: int
    map_size: float
    start: Vector
    target: Vector
    supply_waves: _containers.RepeatedCompositeFieldContainer[SupplyWave]
    seed: int
    step_budget: float
    time_bank: float
    target_distance: float
    pick_up_distance: float
    supply_sight: float
    clip_size: int
    start_health: int
    respawns: bool
    supply_goal: int
    senses: str
    turn_speed: float
    spread: float
    recoil: float
    walking_sway: float
    turning_sway: float
    bounty: int
    clock: str
    token_time: float
    processor_time: float
    def __init__(self, protocol_version: _Optional[int] = ..., track: _Optional[str] = ..., seat: _Optional[int] = ..., seats: _Optional[int] = ..., team: _Optional[int] = ..., time_limit: _Optional[float] = ..., frames_per_action: _Optional[int] = ..., frames_per_second: _Optional[int] = ..., map_size: _Optional[float] = ..., start: _Optional[_Union[Vector, _Mapping]] = ..., target: _Optional[_Union[Vector, _Mapping]] = ..., supply_waves: _Optional[_Iterable[_Union[SupplyWave, _Mapping]]] = ..., seed: _Optional[int] = ..., step_budget: _Optional[float] = ..., time_bank: _Optional[float] = ..., target_distance: _Optional[float] = ..., pick_up_distance: _Optional[float] = ..., supply_sight: _Optional[float] = ..., clip_size: _Optional[int] = ..., start_health: _Optional[int] = ..., respawns: _Optional[bool] = ..., supply_goal: _Optional[int] = ..., senses: _Optional[str] = ..., turn_speed: _Optional[float] = ..., spread: _Optional[float] = ..., recoil: _Optional[float] = ..., walking_sway: _Optional[float] = ..., turning_sway: _Optional[float] = ..., bounty: _Optional[int] = ..., clock: _Optional[str] = ..., token_time: _Optional[float] = ..., processor_time: _Optional[float] = ...) -> None: ...

class SupplyWave(_message.Message):
    __slots__ = ("time", "center_x", "center_z", "radius")
    TIME_FIELD_NUMBER: _ClassVar[int]
    CENTER_X_FIELD_NUMBER: _ClassVar[int]
    CENTER_Z_FIELD_NUMBER: _ClassVar[int]
    RADIUS_FIELD_NUMBER: _ClassVar[int]
    time: float
    center_x: float
    center_z: float
    radius: float
    def __init__(self, time: _Optional[float] = ..., center_x: _Optional[float] = ..., center_z: _Optional[float] = ..., radius: _Optional[float] = ...) -> None: ...

class Observation(_message.Message):
    __slots__ = ("step", "frame", "time_bank", "position", "velocity", "yaw", "pitch", "on_ground", "in_water", "health", "clip", "spare_ammo", "reloading", "fired", "hit_seat", "hit_by_seat", "invincible", "respawn_in", "can_pick_up", "supplies", "gained", "agents", "supply_boxes", "tensors", "target", "team_supplies", "reload_in", "invincible_in")
    STEP_FIELD_NUMBER: _ClassVar[int]
    FRAME_FIELD_NUMBER: _ClassVar[int]
    TIME_BANK_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    PITCH_FIELD_NUMBER: _ClassVar[int]
    ON_GROUND_FIELD_NUMBER: _ClassVar[int]
    IN_WATER_FIELD_NUMBER: _ClassVar[int]
    HEALTH_FIELD_NUMBER: _ClassVar[int]
    CLIP_FIELD_NUMBER: _ClassVar[int]
    SPARE_AMMO_FIELD_NUMBER: _ClassVar[int]
    RELOADING_FIELD_NUMBER: _ClassVar[int]
    FIRED_FIELD_NUMBER: _ClassVar[int]
    HIT_SEAT_FIELD_NUMBER: _ClassVar[int]
    HIT_BY_SEAT_FIELD_NUMBER: _ClassVar[int]
    INVINCIBLE_FIELD_NUMBER: _ClassVar[int]
    RESPAWN_IN_FIELD_NUMBER: _ClassVar[int]
    CAN_PICK_UP_FIELD_NUMBER: _ClassVar[int]
    SUPPLIES_FIELD_NUMBER: _ClassVar[int]
    GAINED_FIELD_NUMBER: _ClassVar[int]
    AGENTS_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_BOXES_FIELD_NUMBER: _ClassVar[int]
    TENSORS_FIELD_NUMBER: _ClassVar[int]
    TARGET_FIELD_NUMBER: _ClassVar[int]
    TEAM_SUPPLIES_FIELD_NUMBER: _ClassVar[int]
    RELOAD_IN_FIELD_NUMBER: _ClassVar[int]
    INVINCIBLE_IN_FIELD_NUMBER: _ClassVar[int]
    step: int
    frame: int
    time_bank: float
    position: Vector
    velocity: Vector
    yaw: float
    pitch: float
    on_ground: bool
    in_water: bool
    health: int
    clip: int
    spare_ammo: int
    reloading: bool
    fired: bool
    hit_seat: int
    hit_by_seat: int
    invincible: bool
    respawn_in: float
    can_pick_up: bool
    supplies: int
    gained: int
    agents: _containers.RepeatedCompositeFieldContainer[VisibleAgent]
    supply_boxes: _containers.RepeatedCompositeFieldContainer[SupplyBox]
    tensors: _containers.RepeatedCompositeFieldContainer[Tensor]
    target: Vector
    team_supplies: int
    reload_in: float
    invincible_in: float
    def __init__(self, step: _Optional[int] = ..., frame: _Optional[int] = ..., time_bank: _Optional[float] = ..., position: _Optional[_Union[Vector, _Mapping]] = ..., velocity: _Optional[_Union[Vector, _Mapping]] = ..., yaw: _Optional[float] = ..., pitch: _Optional[float] = ..., on_ground: _Optional[bool] = ..., in_water: _Optional[bool] = ..., health: _Optional[int] = ..., clip: _Optional[int] = ..., spare_ammo: _Optional[int] = ..., reloading: _Optional[bool] = ..., fired: _Optional[bool] = ..., hit_seat: _Optional[int] = ..., hit_by_seat: _Optional[int] = ..., invincible: _Optional[bool] = ..., respawn_in: _Optional[float] = ..., can_pick_up: _Optional[bool] = ..., supplies: _Optional[int] = ..., gained: _Optional[int] = ..., agents: _Optional[_Iterable[_Union[VisibleAgent, _Mapping]]] = ..., supply_boxes: _Optional[_Iterable[_Union[SupplyBox, _Mapping]]] = ..., tensors: _Optional[_Iterable[_Union[Tensor, _Mapping]]] = ..., target: _Optional[_Union[Vector, _Mapping]] = ..., team_supplies: _Optional[int] = ..., reload_in: _Optional[float] = ..., invincible_in: _Optional[float] = ...) -> None: ...

class VisibleAgent(_message.Message):
    __slots__ = ("seat", "team", "position", "velocity", "yaw", "health", "invincible")
    SEAT_FIELD_NUMBER: _ClassVar[int]
    TEAM_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    HEALTH_FIELD_NUMBER: _ClassVar[int]
    INVINCIBLE_FIELD_NUMBER: _ClassVar[int]
    seat: int
    team: int
    position: Vector
    velocity: Vector
    yaw: float
    health: int
    invincible: bool
    def __init__(self, seat: _Optional[int] = ..., team: _Optional[int] = ..., position: _Optional[_Union[Vector, _Mapping]] = ..., velocity: _Optional[_Union[Vector, _Mapping]] = ..., yaw: _Optional[float] = ..., health: _Optional[int] = ..., invincible: _Optional[bool] = ...) -> None: ...

class SupplyBox(_message.Message):
    __slots__ = ("id", "position", "quantity")
    ID_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    QUANTITY_FIELD_NUMBER: _ClassVar[int]
    id: int
    position: Vector
    quantity: int
    def __init__(self, id: _Optional[int] = ..., position: _Optional[_Union[Vector, _Mapping]] = ..., quantity: _Optional[int] = ...) -> None: ...

class Tensor(_message.Message):
    __slots__ = ("name", "dtype", "shape", "data")
    NAME_FIELD_NUMBER: _ClassVar[int]
    DTYPE_FIELD_NUMBER: _ClassVar[int]
    SHAPE_FIELD_NUMBER: _ClassVar[int]
    DATA_FIELD_NUMBER: _ClassVar[int]
    name: str
    dtype: str
    shape: _containers.RepeatedScalarFieldContainer[int]
    data: bytes
    def __init__(self, name: _Optional[str] = ..., dtype: _Optional[str] = ..., shape: _Optional[_Iterable[int]] = ..., data: _Optional[bytes] = ...) -> None: ...

class MatchOver(_message.Message):
    __slots__ = ("result", "steps", "frames", "conduct")
    RESULT_FIELD_NUMBER: _ClassVar[int]
    STEPS_FIELD_NUMBER: _ClassVar[int]
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    CONDUCT_FIELD_NUMBER: _ClassVar[int]
    result: SeatResult
    steps: int
    frames: int
    conduct: SeatConduct
    def __init__(self, result: _Optional[_Union[SeatResult, _Mapping]] = ..., steps: _Optional[int] = ..., frames: _Optional[int] = ..., conduct: _Optional[_Union[SeatConduct, _Mapping]] = ...) -> None: ...

class SeatResult(_message.Message):
    __slots__ = ("seat", "team", "filled_by", "name", "supplies", "kills", "deaths", "shots", "hits", "walked", "metrics")
    class MetricsEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: str
        value: float
        def __init__(self, key: _Optional[str] = ..., value: _Optional[float] = ...) -> None: ...
    SEAT_FIELD_NUMBER: _ClassVar[int]
    TEAM_FIELD_NUMBER: _ClassVar[int]
    FILLED_BY_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    SUPPLIES_FIELD_NUMBER: _ClassVar[int]
    KILLS_FIELD_NUMBER: _ClassVar[int]
    DEATHS_FIELD_NUMBER: _ClassVar[int]
    SHOTS_FIELD_NUMBER: _ClassVar[int]
    HITS_FIELD_NUMBER: _ClassVar[int]
    WALKED_FIELD_NUMBER: _ClassVar[int]
    METRICS_FIELD_NUMBER: _ClassVar[int]
    seat: int
    team: int
    filled_by: str
    name: str
    supplies: int
    kills: int
    deaths: int
    shots: int
    hits: int
    walked: float
    metrics: _containers.ScalarMap[str, float]
    def __init__(self, seat: _Optional[int] = ..., team: _Optional[int] = ..., filled_by: _Optional[str] = ..., name: _Optional[str] = ..., supplies: _Optional[int] = ..., kills: _Optional[int] = ..., deaths: _Optional[int] = ..., shots: _Optional[int] = ..., hits: _Optional[int] = ..., walked: _Optional[float] = ..., metrics: _Optional[_Mapping[str, float]] = ...) -> None: ...

class SeatConduct(_message.Message):
    __slots__ = ("status", "detail", "steps_played", "late_steps", "dropped_actions", "invalid_actions", "ignored_fields", "fault", "time_used", "latency_p50", "latency_p99", "latency_max", "time_bank")
    STATUS_FIELD_NUMBER: _ClassVar[int]
    DETAIL_FIELD_NUMBER: _ClassVar[int]
    STEPS_PLAYED_FIELD_NUMBER: _ClassVar[int]
    LATE_STEPS_FIELD_NUMBER: _ClassVar[int]
    DROPPED_ACTIONS_FIELD_NUMBER: _ClassVar[int]
    INVALID_ACTIONS_FIELD_NUMBER: _ClassVar[int]
    IGNORED_FIELDS_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    TIME_USED_FIELD_NUMBER: _ClassVar[int]
    LATENCY_P50_FIELD_NUMBER: _ClassVar[int]
    LATENCY_P99_FIELD_NUMBER: _ClassVar[int]
    LATENCY_MAX_FIELD_NUMBER: _ClassVar[int]
    TIME_BANK_FIELD_NUMBER: _ClassVar[int]
    status: str
    detail: str
    steps_played: int
    late_steps: int
    dropped_actions: int
    invalid_actions: int
    ignored_fields: int
    fault: str
    time_used: float
    latency_p50: float
    latency_p99: float
    latency_max: float
    time_bank: float
    def __init__(self, status: _Optional[str] = ..., detail: _Optional[str] = ..., steps_played: _Optional[int] = ..., late_steps: _Optional[int] = ..., dropped_actions: _Optional[int] = ..., invalid_actions: _Optional[int] = ..., ignored_fields: _Optional[int] = ..., fault: _Optional[str] = ..., time_used: _Optional[float] = ..., latency_p50: _Optional[float] = ..., latency_p99: _Optional[float] = ..., latency_max: _Optional[float] = ..., time_bank: _Optional[float] = ...) -> None: ...

class HostMatchRequest(_message.Message):
    __slots__ = ("spec_json", "names", "sensors_json")
    class SensorsJsonEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: int
        value: str
        def __init__(self, key: _Optional[int] = ..., value: _Optional[str] = ...) -> None: ...
    SPEC_JSON_FIELD_NUMBER: _ClassVar[int]
    NAMES_FIELD_NUMBER: _ClassVar[int]
    SENSORS_JSON_FIELD_NUMBER: _ClassVar[int]
    spec_json: str
    names: _containers.RepeatedScalarFieldContainer[str]
    sensors_json: _containers.ScalarMap[int, str]
    def __init__(self, spec_json: _Optional[str] = ..., names: _Optional[_Iterable[str]] = ..., sensors_json: _Optional[_Mapping[int, str]] = ...) -> None: ...

class HostMatchResponse(_message.Message):
    __slots__ = ("match_id", "seat_tokens", "join_timeout", "seat_address")
    class SeatTokensEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: int
        value: str
        def __init__(self, key: _Optional[int] = ..., value: _Optional[str] = ...) -> None: ...
    MATCH_ID_FIELD_NUMBER: _ClassVar[int]
    SEAT_TOKENS_FIELD_NUMBER: _ClassVar[int]
    JOIN_TIMEOUT_FIELD_NUMBER: _ClassVar[int]
    SEAT_ADDRESS_FIELD_NUMBER: _ClassVar[int]
    match_id: str
    seat_tokens: _containers.ScalarMap[int, str]
    join_timeout: float
    seat_address: str
    def __init__(self, match_id: _Optional[str] = ..., seat_tokens: _Optional[_Mapping[int, str]] = ..., join_timeout: _Optional[float] = ..., seat_address: _Optional[str] = ...) -> None: ...

class GetMatchRequest(_message.Message):
    __slots__ = ("match_id",)
    MATCH_ID_FIELD_NUMBER: _ClassVar[int]
    match_id: str
    def __init__(self, match_id: _Optional[str] = ...) -> None: ...

class GetMatchResponse(_message.Message):
    __slots__ = ("state", "steps", "results", "conduct", "record", "error")
    class State(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        STATE_UNSPECIFIED: _ClassVar[GetMatchResponse.State]
        STATE_JOINING: _ClassVar[GetMatchResponse.State]
        STATE_PLAYING: _ClassVar[GetMatchResponse.State]
        STATE_FINISHED: _ClassVar[GetMatchResponse.State]
        STATE_FAILED: _ClassVar[GetMatchResponse.State]
    STATE_UNSPECIFIED: GetMatchResponse.State
    STATE_JOINING: GetMatchResponse.State
    STATE_PLAYING: GetMatchResponse.State
    STATE_FINISHED: GetMatchResponse.State
    STATE_FAILED: GetMatchResponse.State
    class ConductEntry(_message.Message):
        __slots__ = ("key", "value")
        KEY_FIELD_NUMBER: _ClassVar[int]
        VALUE_FIELD_NUMBER: _ClassVar[int]
        key: int
        value: SeatConduct
        def __init__(self, key: _Optional[int] = ..., value: _Optional[_Union[SeatConduct, _Mapping]] = ...) -> None: ...
    STATE_FIELD_NUMBER: _ClassVar[int]
    STEPS_FIELD_NUMBER: _ClassVar[int]
    RESULTS_FIELD_NUMBER: _ClassVar[int]
    CONDUCT_FIELD_NUMBER: _ClassVar[int]
    RECORD_FIELD_NUMBER: _ClassVar[int]
    ERROR_FIELD_NUMBER: _ClassVar[int]
    state: GetMatchResponse.State
    steps: int
    results: _containers.RepeatedCompositeFieldContainer[SeatResult]
    conduct: _containers.MessageMap[int, SeatConduct]
    record: bytes
    error: str
    def __init__(self, state: _Optional[_Union[GetMatchResponse.State, str]] = ..., steps: _Optional[int] = ..., results: _Optional[_Iterable[_Union[SeatResult, _Mapping]]] = ..., conduct: _Optional[_Mapping[int, SeatConduct]] = ..., record: _Optional[bytes] = ..., error: _Optional[str] = ...) -> None: ...
