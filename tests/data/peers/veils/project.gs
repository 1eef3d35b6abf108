<?xml version="1.0" encoding="UTF-8"?><project xmlns="http://grogra.de/registry" graph="graph.xml">
<import plugin="de.grogra.imp3d" version="1.5"/>
<registry>
<ref name="project"><ref name="objects"><ref name="images"></ref></ref></ref>
<ref name="workbench"><ref name="state">
<de.grogra.pf.ui.registry.Layout name="layout"><de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.6981317007977318] transformation=(1.0 0.0 -0.0 0.0 0.0 0.3219027332387023 0.9467727448197126 -0.7574181958557702 0.0 -0.9467727448197126 0.3219027332387023 -5.538620557195318 0.0 0.0 0.0 1.0))"/></de.grogra.pf.ui.registry.Layout>
</ref></ref>
</registry></project>
