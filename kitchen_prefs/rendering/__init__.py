"""Pictures of the kitchen, drawn by MuJoCo's renderer.

state          what a picture shows, in plain numbers
meshes         surfaces as triangles
tableware      the dishes' surfaces and glazes
textures       wood, steel and tiles
parts          boxes, bars and slabs with materials
room           walls, cabinets, counter and sink
dishwasher     its body, door and racks
kitchen_model  all of it as one MuJoCo model
opengl         a context that draws without a display
renderer       a picture of a state
"""
