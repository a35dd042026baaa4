"""Country that must be seen to be crossed: wards behind barriers, walled towns, hidden targets."""

from wildscav_engine.maps.country.plan import CountryPlan, barriers_of, plan_country, shape_country

__all__ = ["CountryPlan", "barriers_of", "plan_country", "shape_country"]
