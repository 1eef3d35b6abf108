<?xml version="1.0" encoding="UTF-8"?><project xmlns="http://grogra.de/registry" graph="graph.xml">
<import plugin="de.grogra.imp3d" version="1.5"/>
<registry>
<ref name="project"><ref name="objects">
<ref name="images"></ref>
<ref name="3d"><ref name="shaders"></ref></ref>
</ref></ref>
<ref name="workbench"><ref name="state">
<de.grogra.pf.ui.registry.Layout name="layout"><de.grogra.pf.ui.registry.MainWindow><de.grogra.pf.ui.registry.PanelFactory source="/ui/panels/3d/defaultview"><de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="graphDescriptor=[de.grogra.imp.ProjectGraphDescriptor] visibleLayers={true true true true true true true true true true true true true true true true} epsilon=1.0E-6 visualEpsilon=0.01 magnitude=1.0 camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.698131701] transformation=(0.999723299 0.0235229011 -1.34482791e-13 -0.0999723302 -0.007357857 0.312708923 0.949820505 -0.759120615 0.0223425338 -0.949557688 0.312795474 -9.20400681 0 0 0 1)) navigator=null"/></de.grogra.pf.ui.registry.PanelFactory></de.grogra.pf.ui.registry.MainWindow></de.grogra.pf.ui.registry.Layout>
</ref></ref>
</registry></project>
