// The kitchens of the page: those to show in, those to load, and those that lack a kind of dish.

const kitchens = {
  all: Object.values(data.kitchens).flat(),
  turns: Object.fromEntries(Object.keys(data.kitchens).map((use) => [use, 0])),

  /** The next kitchen for a use: "show", "load", "incomplete" or "study". */
  next(use) {
    const own = data.kitchens[use];
    const kitchen = own[this.turns[use] % own.length];
    this.turns[use] += 1;
    return kitchen;
  },

  /** A name that a kitchen has in every page that shows it. */
  nameOf({ split, index, salt }) {
    return [data.version, split, index, salt].join(" ");
  },

  named(name) {
    return this.all.find((kitchen) => this.nameOf(kitchen) === name);
  },

  /** The categories of which a kitchen has no dish. */
  lacking(kitchen) {
    const there = new Set(dishesOf(kitchen).map(({ category }) => category));
    return [...data.layout.categories.keys()].filter((category) => !there.has(category));
  },
};
