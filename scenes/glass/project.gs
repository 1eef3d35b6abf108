<?xml version="1.0" encoding="UTF-8"?>
<project xmlns="http://grogra.de/registry" graph="graph.xml">
 <import plugin="de.grogra.vecmath" version="1.5"/>
 <import plugin="de.grogra.imp3d" version="1.5"/>
 <import plugin="de.grogra.math" version="1.5"/>
 <import plugin="de.grogra.pf" version="1.5"/>
 <import plugin="de.grogra.imp" version="1.5"/>
 <registry>
  <ref name="workbench">
   <ref name="state">
    <de.grogra.pf.ui.registry.Layout name="layout">
     <de.grogra.pf.ui.registry.MainWindow>
      <de.grogra.pf.ui.registry.PanelFactory source="/ui/panels/3d/defaultview">
       <de.grogra.pf.registry.Option name="panelId" type="java.lang.String" value="/ui/panels/3d/defaultview"/>
       <de.grogra.pf.registry.Option name="panelTitle" type="java.lang.String" value="View"/>
       <de.grogra.pf.registry.Option name="view" type="de.grogra.imp3d.View3D" value="graphDescriptor=[de.grogra.imp.ProjectGraphDescriptor]visibleLayers={true true true true true true true true true true true true true true true true}epsilon=1.0E-6 visualEpsilon=0.01 magnitude=1.0 camera=(minZ=0.1 maxZ=2000.0 projection=[de.grogra.imp3d.PerspectiveProjection aspect=1.0 fieldOfView=0.76]transformation=(1 0 0 -0 -0 0.3877299 0.921773 -0.6232941 0 -0.921773 0.3877299 -6.771374 0.0 0.0 0.0 1.0))navigator=null"/>
      </de.grogra.pf.ui.registry.PanelFactory>
     </de.grogra.pf.ui.registry.MainWindow>
    </de.grogra.pf.ui.registry.Layout>
   </ref>
  </ref>
 </registry>
</project>
