from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class GameMode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    NAVIGATION_MODE: _ClassVar[GameMode]
    SUP_GATHER_MODE: _ClassVar[GameMode]
    SUP_BATTLE_MODE: _ClassVar[GameMode]

class GameState(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    START: _ClassVar[GameState]
    RESET: _ClassVar[GameState]
    UPDATE: _ClassVar[GameState]
    CLOSE: _ClassVar[GameState]
    OVER: _ClassVar[GameState]
NAVIGATION_MODE: GameMode
SUP_GATHER_MODE: GameMode
SUP_BATTLE_MODE: GameMode
START: GameState
RESET: GameState
UPDATE: GameState
CLOSE: GameState
OVER: GameState

class Vector3(_message.Message):
    __slots__ = ("x", "y", "z")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    x: float
    y: float
    z: float
    def __init__(self, x: _Optional[float] = ..., y: _Optional[float] = ..., z: _Optional[float] = ...) -> None: ...

class SupplyInfo(_message.Message):
    __slots__ = ("supply_id", "supply_location", "supply_quantity")
    SUPPLY_ID_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_LOCATION_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_QUANTITY_FIELD_NUMBER: _ClassVar[int]
    supply_id: int
    supply_location: Vector3
    supply_quantity: int
    def __init__(self, supply_id: _Optional[int] = ..., supply_location: _Optional[_Union[Vector3, _Mapping]] = ..., supply_quantity: _Optional[int] = ...) -> None: ...

class EnemyInfo(_message.Message):
    __slots__ = ("location", "move_dir", "move_speed", "hp", "enemy_id", "is_respawn", "is_invincible")
    LOCATION_FIELD_NUMBER: _ClassVar[int]
    MOVE_DIR_FIELD_NUMBER: _ClassVar[int]
    MOVE_SPEED_FIELD_NUMBER: _ClassVar[int]
    HP_FIELD_NUMBER: _ClassVar[int]
    ENEMY_ID_FIELD_NUMBER: _ClassVar[int]
    IS_RESPAWN_FIELD_NUMBER: _ClassVar[int]
    IS_INVINCIBLE_FIELD_NUMBER: _ClassVar[int]
    location: Vector3
    move_dir: Vector3
    move_speed: float
    hp: int
    enemy_id: int
    is_respawn: bool
    is_invincible: bool
    def __init__(self, location: _Optional[_Union[Vector3, _Mapping]] = ..., move_dir: _Optional[_Union[Vector3, _Mapping]] = ..., move_speed: _Optional[float] = ..., hp: _Optional[int] = ..., enemy_id: _Optional[int] = ..., is_respawn: _Optional[bool] = ..., is_invincible: _Optional[bool] = ...) -> None: ...

class Observation(_message.Message):
    __slots__ = ("id", "location", "pitch", "yaw", "hp", "move_dir", "move_speed", "num_gun_ammo", "num_pack_ammo", "on_ground", "is_fire", "is_reload", "hit_enemy", "hit_by_enemy", "can_pickup", "supply_info_list", "enemy_info_list", "num_supply", "is_waiting_respawn", "is_invincible", "hit_enemy_id", "hit_by_enemy_id", "image")
    ID_FIELD_NUMBER: _ClassVar[int]
    LOCATION_FIELD_NUMBER: _ClassVar[int]
    PITCH_FIELD_NUMBER: _ClassVar[int]
    YAW_FIELD_NUMBER: _ClassVar[int]
    HP_FIELD_NUMBER: _ClassVar[int]
    MOVE_DIR_FIELD_NUMBER: _ClassVar[int]
    MOVE_SPEED_FIELD_NUMBER: _ClassVar[int]
    NUM_GUN_AMMO_FIELD_NUMBER: _ClassVar[int]
    NUM_PACK_AMMO_FIELD_NUMBER: _ClassVar[int]
    ON_GROUND_FIELD_NUMBER: _ClassVar[int]
    IS_FIRE_FIELD_NUMBER: _ClassVar[int]
    IS_RELOAD_FIELD_NUMBER: _ClassVar[int]
    HIT_ENEMY_FIELD_NUMBER: _ClassVar[int]
    HIT_BY_ENEMY_FIELD_NUMBER: _ClassVar[int]
    CAN_PICKUP_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_INFO_LIST_FIELD_NUMBER: _ClassVar[int]
    ENEMY_INFO_LIST_FIELD_NUMBER: _ClassVar[int]
    NUM_SUPPLY_FIELD_NUMBER: _ClassVar[int]
    IS_WAITING_RESPAWN_FIELD_NUMBER: _ClassVar[int]
    IS_INVINCIBLE_FIELD_NUMBER: _ClassVar[int]
    HIT_ENEMY_ID_FIELD_NUMBER: _ClassVar[int]
    HIT_BY_ENEMY_ID_FIELD_NUMBER: _ClassVar[int]
    IMAGE_FIELD_NUMBER: _ClassVar[int]
    id: int
    location: Vector3
    pitch: float
    yaw: float
    hp: int
    move_dir: Vector3
    move_speed: float
    num_gun_ammo: int
    num_pack_ammo: int
    on_ground: bool
    is_fire: bool
    is_reload: bool
    hit_enemy: bool
    hit_by_enemy: bool
    can_pickup: bool
    supply_info_list: _containers.RepeatedCompositeFieldContainer[SupplyInfo]
    enemy_info_list: _containers.RepeatedCompositeFieldContainer[EnemyInfo]
    num_supply: int
    is_waiting_respawn: bool
    is_invincible: bool
    hit_enemy_id: int
    hit_by_enemy_id: int
    image: bytes
    def __init__(self, id: _Optional[int] = ..., location: _Optional[_Union[Vector3, _Mapping]] = ..., pitch: _Optional[float] = ..., yaw: _Optional[float] = ..., hp: _Optional[int] = ..., move_dir: _Optional[_Union[Vector3, _Mapping]] = ..., move_speed: _Optional[float] = ..., num_gun_ammo: _Optional[int] = ..., num_pack_ammo: _Optional[int] = ..., on_ground: _Optional[bool] = ..., is_fire: _Optional[bool] = ..., is_reload: _Optional[bool] = ..., hit_enemy: _Optional[bool] = ..., hit_by_enemy: _Optional[bool] = ..., can_pickup: _Optional[bool] = ..., supply_info_list: _Optional[_Iterable[_Union[SupplyInfo, _Mapping]]] = ..., enemy_info_list: _Optional[_Iterable[_Union[EnemyInfo, _Mapping]]] = ..., num_supply: _Optional[int] = ..., is_waiting_respawn: _Optional[bool] = ..., is_invincible: _Optional[bool] = ..., hit_enemy_id: _Optional[int] = ..., hit_by_enemy_id: _Optional[int] = ..., image: _Optional[bytes] = ...) -> None: ...

class AgentCommand(_message.Message):
    __slots__ = ("id", "walk_dir", "walk_speed", "jump", "turn_left_right_delta", "look_up_down_delta", "shoot_gun", "reload", "collect")
    ID_FIELD_NUMBER: _ClassVar[int]
    WALK_DIR_FIELD_NUMBER: _ClassVar[int]
    WALK_SPEED_FIELD_NUMBER: _ClassVar[int]
    JUMP_FIELD_NUMBER: _ClassVar[int]
    TURN_LEFT_RIGHT_DELTA_FIELD_NUMBER: _ClassVar[int]
    LOOK_UP_DOWN_DELTA_FIELD_NUMBER: _ClassVar[int]
    SHOOT_GUN_FIELD_NUMBER: _ClassVar[int]
    RELOAD_FIELD_NUMBER: _ClassVar[int]
    COLLECT_FIELD_NUMBER: _ClassVar[int]
    id: int
    walk_dir: float
    walk_speed: float
    jump: bool
    turn_left_right_delta: float
    look_up_down_delta: float
    shoot_gun: bool
    reload: bool
    collect: bool
    def __init__(self, id: _Optional[int] = ..., walk_dir: _Optional[float] = ..., walk_speed: _Optional[float] = ..., jump: _Optional[bool] = ..., turn_left_right_delta: _Optional[float] = ..., look_up_down_delta: _Optional[float] = ..., shoot_gun: _Optional[bool] = ..., reload: _Optional[bool] = ..., collect: _Optional[bool] = ...) -> None: ...

class SupplyRefreshData(_message.Message):
    __slots__ = ("supply_heatmap_center", "supply_heatmap_radius", "supply_refresh_time", "supply_create_percent", "supply_house_create_percent")
    SUPPLY_HEATMAP_CENTER_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HEATMAP_RADIUS_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_REFRESH_TIME_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_CREATE_PERCENT_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HOUSE_CREATE_PERCENT_FIELD_NUMBER: _ClassVar[int]
    supply_heatmap_center: Vector3
    supply_heatmap_radius: int
    supply_refresh_time: int
    supply_create_percent: int
    supply_house_create_percent: int
    def __init__(self, supply_heatmap_center: _Optional[_Union[Vector3, _Mapping]] = ..., supply_heatmap_radius: _Optional[int] = ..., supply_refresh_time: _Optional[int] = ..., supply_create_percent: _Optional[int] = ..., supply_house_create_percent: _Optional[int] = ...) -> None: ...

class AgentSetup(_message.Message):
    __slots__ = ("id", "hp", "num_pack_ammo", "gun_capacity", "attack_power", "start_location", "agent_name")
    ID_FIELD_NUMBER: _ClassVar[int]
    HP_FIELD_NUMBER: _ClassVar[int]
    NUM_PACK_AMMO_FIELD_NUMBER: _ClassVar[int]
    GUN_CAPACITY_FIELD_NUMBER: _ClassVar[int]
    ATTACK_POWER_FIELD_NUMBER: _ClassVar[int]
    START_LOCATION_FIELD_NUMBER: _ClassVar[int]
    AGENT_NAME_FIELD_NUMBER: _ClassVar[int]
    id: int
    hp: int
    num_pack_ammo: int
    gun_capacity: int
    attack_power: int
    start_location: Vector3
    agent_name: str
    def __init__(self, id: _Optional[int] = ..., hp: _Optional[int] = ..., num_pack_ammo: _Optional[int] = ..., gun_capacity: _Optional[int] = ..., attack_power: _Optional[int] = ..., start_location: _Optional[_Union[Vector3, _Mapping]] = ..., agent_name: _Optional[str] = ...) -> None: ...

class GMCommand(_message.Message):
    __slots__ = ("timeout", "game_mode", "time_scale", "map_id", "random_seed", "target_location", "trigger_range", "supply_heatmap_center", "supply_heatmap_radius", "supply_create_percent", "supply_house_create_percent", "supply_grid_length", "supply_random_min", "supply_random_max", "supply_house_random_min", "supply_house_random_max", "num_agents", "agent_setups", "supply_refresh_datas", "respawn_time", "is_record", "replay_suffix", "is_random_respawn_location", "supply_loss_percent_when_dead", "is_Open_Event", "water_speed_decay", "invincible_time")
    TIMEOUT_FIELD_NUMBER: _ClassVar[int]
    GAME_MODE_FIELD_NUMBER: _ClassVar[int]
    TIME_SCALE_FIELD_NUMBER: _ClassVar[int]
    MAP_ID_FIELD_NUMBER: _ClassVar[int]
    RANDOM_SEED_FIELD_NUMBER: _ClassVar[int]
    TARGET_LOCATION_FIELD_NUMBER: _ClassVar[int]
    TRIGGER_RANGE_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HEATMAP_CENTER_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HEATMAP_RADIUS_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_CREATE_PERCENT_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HOUSE_CREATE_PERCENT_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_GRID_LENGTH_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_RANDOM_MIN_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_RANDOM_MAX_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HOUSE_RANDOM_MIN_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_HOUSE_RANDOM_MAX_FIELD_NUMBER: _ClassVar[int]
    NUM_AGENTS_FIELD_NUMBER: _ClassVar[int]
    AGENT_SETUPS_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_REFRESH_DATAS_FIELD_NUMBER: _ClassVar[int]
    RESPAWN_TIME_FIELD_NUMBER: _ClassVar[int]
    IS_RECORD_FIELD_NUMBER: _ClassVar[int]
    REPLAY_SUFFIX_FIELD_NUMBER: _ClassVar[int]
    IS_RANDOM_RESPAWN_LOCATION_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_LOSS_PERCENT_WHEN_DEAD_FIELD_NUMBER: _ClassVar[int]
    IS_OPEN_EVENT_FIELD_NUMBER: _ClassVar[int]
    WATER_SPEED_DECAY_FIELD_NUMBER: _ClassVar[int]
    INVINCIBLE_TIME_FIELD_NUMBER: _ClassVar[int]
    timeout: int
    game_mode: GameMode
    time_scale: int
    map_id: int
    random_seed: int
    target_location: Vector3
    trigger_range: float
    supply_heatmap_center: Vector3
    supply_heatmap_radius: int
    supply_create_percent: int
    supply_house_create_percent: int
    supply_grid_length: int
    supply_random_min: int
    supply_random_max: int
    supply_house_random_min: int
    supply_house_random_max: int
    num_agents: int
    agent_setups: _containers.RepeatedCompositeFieldContainer[AgentSetup]
    supply_refresh_datas: _containers.RepeatedCompositeFieldContainer[SupplyRefreshData]
    respawn_time: int
    is_record: bool
    replay_suffix: str
    is_random_respawn_location: bool
    supply_loss_percent_when_dead: int
    is_Open_Event: bool
    water_speed_decay: float
    invincible_time: int
    def __init__(self, timeout: _Optional[int] = ..., game_mode: _Optional[_Union[GameMode, str]] = ..., time_scale: _Optional[int] = ..., map_id: _Optional[int] = ..., random_seed: _Optional[int] = ..., target_location: _Optional[_Union[Vector3, _Mapping]] = ..., trigger_range: _Optional[float] = ..., supply_heatmap_center: _Optional[_Union[Vector3, _Mapping]] = ..., supply_heatmap_radius: _Optional[int] = ..., supply_create_percent: _Optional[int] = ..., supply_house_create_percent: _Optional[int] = ..., supply_grid_length: _Optional[int] = ..., supply_random_min: _Optional[int] = ..., supply_random_max: _Optional[int] = ..., supply_house_random_min: _Optional[int] = ..., supply_house_random_max: _Optional[int] = ..., num_agents: _Optional[int] = ..., agent_setups: _Optional[_Iterable[_Union[AgentSetup, _Mapping]]] = ..., supply_refresh_datas: _Optional[_Iterable[_Union[SupplyRefreshData, _Mapping]]] = ..., respawn_time: _Optional[int] = ..., is_record: _Optional[bool] = ..., replay_suffix: _Optional[str] = ..., is_random_respawn_location: _Optional[bool] = ..., supply_loss_percent_when_dead: _Optional[int] = ..., is_Open_Event: _Optional[bool] = ..., water_speed_decay: _Optional[float] = ..., invincible_time: _Optional[int] = ...) -> None: ...

class EventGameStart(_message.Message):
    __slots__ = ("gameMode",)
    GAMEMODE_FIELD_NUMBER: _ClassVar[int]
    gameMode: GameMode
    def __init__(self, gameMode: _Optional[_Union[GameMode, str]] = ...) -> None: ...

class EventSupplyRefresh(_message.Message):
    __slots__ = ("pos", "count", "id")
    POS_FIELD_NUMBER: _ClassVar[int]
    COUNT_FIELD_NUMBER: _ClassVar[int]
    ID_FIELD_NUMBER: _ClassVar[int]
    pos: Vector3
    count: int
    id: int
    def __init__(self, pos: _Optional[_Union[Vector3, _Mapping]] = ..., count: _Optional[int] = ..., id: _Optional[int] = ...) -> None: ...

class EventPlayerSettleInfo(_message.Message):
    __slots__ = ("supply_count", "rank", "move_distance", "kill_count", "dead_count")
    SUPPLY_COUNT_FIELD_NUMBER: _ClassVar[int]
    RANK_FIELD_NUMBER: _ClassVar[int]
    MOVE_DISTANCE_FIELD_NUMBER: _ClassVar[int]
    KILL_COUNT_FIELD_NUMBER: _ClassVar[int]
    DEAD_COUNT_FIELD_NUMBER: _ClassVar[int]
    supply_count: int
    rank: int
    move_distance: float
    kill_count: int
    dead_count: int
    def __init__(self, supply_count: _Optional[int] = ..., rank: _Optional[int] = ..., move_distance: _Optional[float] = ..., kill_count: _Optional[int] = ..., dead_count: _Optional[int] = ...) -> None: ...

class EventSettle(_message.Message):
    __slots__ = ("gameMode", "elapsed_time", "move_distance", "supply_count", "event_player_infos")
    GAMEMODE_FIELD_NUMBER: _ClassVar[int]
    ELAPSED_TIME_FIELD_NUMBER: _ClassVar[int]
    MOVE_DISTANCE_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_COUNT_FIELD_NUMBER: _ClassVar[int]
    EVENT_PLAYER_INFOS_FIELD_NUMBER: _ClassVar[int]
    gameMode: GameMode
    elapsed_time: float
    move_distance: float
    supply_count: int
    event_player_infos: _containers.RepeatedCompositeFieldContainer[EventPlayerSettleInfo]
    def __init__(self, gameMode: _Optional[_Union[GameMode, str]] = ..., elapsed_time: _Optional[float] = ..., move_distance: _Optional[float] = ..., supply_count: _Optional[int] = ..., event_player_infos: _Optional[_Iterable[_Union[EventPlayerSettleInfo, _Mapping]]] = ...) -> None: ...

class EventSystem(_message.Message):
    __slots__ = ("event_game_start", "event_supplyrefrsh", "event_settle")
    EVENT_GAME_START_FIELD_NUMBER: _ClassVar[int]
    EVENT_SUPPLYREFRSH_FIELD_NUMBER: _ClassVar[int]
    EVENT_SETTLE_FIELD_NUMBER: _ClassVar[int]
    event_game_start: EventGameStart
    event_supplyrefrsh: EventSupplyRefresh
    event_settle: EventSettle
    def __init__(self, event_game_start: _Optional[_Union[EventGameStart, _Mapping]] = ..., event_supplyrefrsh: _Optional[_Union[EventSupplyRefresh, _Mapping]] = ..., event_settle: _Optional[_Union[EventSettle, _Mapping]] = ...) -> None: ...

class EventAgentRefresh(_message.Message):
    __slots__ = ("pos",)
    POS_FIELD_NUMBER: _ClassVar[int]
    pos: Vector3
    def __init__(self, pos: _Optional[_Union[Vector3, _Mapping]] = ...) -> None: ...

class EventAgentDead(_message.Message):
    __slots__ = ("pos",)
    POS_FIELD_NUMBER: _ClassVar[int]
    pos: Vector3
    def __init__(self, pos: _Optional[_Union[Vector3, _Mapping]] = ...) -> None: ...

class EventAgentBeHit(_message.Message):
    __slots__ = ("damageValue", "fire_id")
    DAMAGEVALUE_FIELD_NUMBER: _ClassVar[int]
    FIRE_ID_FIELD_NUMBER: _ClassVar[int]
    damageValue: int
    fire_id: int
    def __init__(self, damageValue: _Optional[int] = ..., fire_id: _Optional[int] = ...) -> None: ...

class EventAgentReloadSuccess(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class EventGetSupplySuccess(_message.Message):
    __slots__ = ("supply_id", "supply_count", "pos")
    SUPPLY_ID_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_COUNT_FIELD_NUMBER: _ClassVar[int]
    POS_FIELD_NUMBER: _ClassVar[int]
    supply_id: int
    supply_count: int
    pos: Vector3
    def __init__(self, supply_id: _Optional[int] = ..., supply_count: _Optional[int] = ..., pos: _Optional[_Union[Vector3, _Mapping]] = ...) -> None: ...

class EventAgent(_message.Message):
    __slots__ = ("player_id", "supply_num_rank", "event_agent_refresh", "event_agent_dead", "event_agent_beHited", "event_agent_reload_success", "event_get_supply_success")
    PLAYER_ID_FIELD_NUMBER: _ClassVar[int]
    SUPPLY_NUM_RANK_FIELD_NUMBER: _ClassVar[int]
    EVENT_AGENT_REFRESH_FIELD_NUMBER: _ClassVar[int]
    EVENT_AGENT_DEAD_FIELD_NUMBER: _ClassVar[int]
    EVENT_AGENT_BEHITED_FIELD_NUMBER: _ClassVar[int]
    EVENT_AGENT_RELOAD_SUCCESS_FIELD_NUMBER: _ClassVar[int]
    EVENT_GET_SUPPLY_SUCCESS_FIELD_NUMBER: _ClassVar[int]
    player_id: int
    supply_num_rank: int
    event_agent_refresh: EventAgentRefresh
    event_agent_dead: EventAgentDead
    event_agent_beHited: EventAgentBeHit
    event_agent_reload_success: EventAgentReloadSuccess
    event_get_supply_success: EventGetSupplySuccess
    def __init__(self, player_id: _Optional[int] = ..., supply_num_rank: _Optional[int] = ..., event_agent_refresh: _Optional[_Union[EventAgentRefresh, _Mapping]] = ..., event_agent_dead: _Optional[_Union[EventAgentDead, _Mapping]] = ..., event_agent_beHited: _Optional[_Union[EventAgentBeHit, _Mapping]] = ..., event_agent_reload_success: _Optional[_Union[EventAgentReloadSuccess, _Mapping]] = ..., event_get_supply_success: _Optional[_Union[EventGetSupplySuccess, _Mapping]] = ...) -> None: ...

class EventInfo(_message.Message):
    __slots__ = ("timeStep", "event_system", "event_agentInfos")
    TIMESTEP_FIELD_NUMBER: _ClassVar[int]
    EVENT_SYSTEM_FIELD_NUMBER: _ClassVar[int]
    EVENT_AGENTINFOS_FIELD_NUMBER: _ClassVar[int]
    timeStep: int
    event_system: EventSystem
    event_agentInfos: _containers.RepeatedCompositeFieldContainer[EventAgent]
    def __init__(self, timeStep: _Optional[int] = ..., event_system: _Optional[_Union[EventSystem, _Mapping]] = ..., event_agentInfos: _Optional[_Iterable[_Union[EventAgent, _Mapping]]] = ...) -> None: ...

class Request(_message.Message):
    __slots__ = ("game_state", "time_step", "agent_obs_list", "event_info")
    GAME_STATE_FIELD_NUMBER: _ClassVar[int]
    TIME_STEP_FIELD_NUMBER: _ClassVar[int]
    AGENT_OBS_LIST_FIELD_NUMBER: _ClassVar[int]
    EVENT_INFO_FIELD_NUMBER: _ClassVar[int]
    game_state: GameState
    time_step: int
    agent_obs_list: _containers.RepeatedCompositeFieldContainer[Observation]
    event_info: EventInfo
    def __init__(self, game_state: _Optional[_Union[GameState, str]] = ..., time_step: _Optional[int] = ..., agent_obs_list: _Optional[_Iterable[_Union[Observation, _Mapping]]] = ..., event_info: _Optional[_Union[EventInfo, _Mapping]] = ...) -> None: ...

class Reply(_message.Message):
    __slots__ = ("game_state", "gm_cmd", "agent_cmd_list")
    GAME_STATE_FIELD_NUMBER: _ClassVar[int]
    GM_CMD_FIELD_NUMBER: _ClassVar[int]
    AGENT_CMD_LIST_FIELD_NUMBER: _ClassVar[int]
    game_state: GameState
    gm_cmd: GMCommand
    agent_cmd_list: _containers.RepeatedCompositeFieldContainer[AgentCommand]
    def __init__(self, game_state: _Optional[_Union[GameState, str]] = ..., gm_cmd: _Optional[_Union[GMCommand, _Mapping]] = ..., agent_cmd_list: _Optional[_Iterable[_Union[AgentCommand, _Mapping]]] = ...) -> None: ...
