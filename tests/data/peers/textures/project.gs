<?xml version="1.0" encoding="UTF-8"?><project xmlns="http://grogra.de/registry" graph="graph.xml">
<import plugin="de.grogra.imp3d" version="1.5"/>
<registry>
<ref name="project"><ref name="objects"><ref name="images"></ref></ref></ref>
<ref name="workbench"><ref name="state">
<de.grogra.pf.ui.registry.Layout name="layout"><de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.7330382858376184] transformation=(1.0 0.0 -0.0 0.0 0.0 0.48564293117863205 0.8741572761215377 -0.43707863806076896 0.0 -0.8741572761215377 0.48564293117863205 -5.390636536082816 0.0 0.0 0.0 1.0))"/></de.grogra.pf.ui.registry.Layout>
</ref></ref>
</registry></project>
