"""Pictures of the kitchen: by MuJoCo's renderer, and a plan that needs no MuJoCo.

state          what a picture shows, in plain numbers
meshes         surfaces as triangles
tableware      the dishes' surfaces and glazes
coats          rims and stains, as thin surfaces that lie on dishes
palette        the colours of the second tier's materials
finishes       what a dish is drawn as, by its material
textures       wood, steel and tiles
parts          boxes, bars and slabs with materials
room           walls, cabinets, counter and sink
dishwasher     its body, door and racks
kitchen_model  all of it as one MuJoCo model
opengl         a context that draws without a display
renderer       a picture of a state

plan           the kitchen from above before a decision, and what the decision chooses
plan_ground    what a plan has besides dishes
plan_dishes    its dishes, by category or by material
plan_lists     what stands beside its racks
dish_outlines  dishes from above, in any position
canvas         shapes with smooth edges, by pillow
"""
