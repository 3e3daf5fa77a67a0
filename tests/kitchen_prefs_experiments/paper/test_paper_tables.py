"""The tables: their names and the paper's values."""

import pytest

from kitchen_prefs_experiments.paper.paper_tables import TABLES, get_table
from kitchen_prefs_experiments.paper.table_types import Table

# All but those of learning curves.
POLICY_TABLES = {name: table for name, table in TABLES.items() if isinstance(table, Table)}


def test_a_table_that_does_not_exist_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'attributes'"):
        get_table("atributes")


@pytest.mark.parametrize("name", POLICY_TABLES)
def test_the_papers_values_stand_where_ours_do(name):
    table = TABLES[name]
    places = table.groups if len(table.groups) > 1 else tuple(table.rows)
    for values in table.paper_values.values():
        assert set(values) <= set(places)
